// Target descriptions (YAML) for the host programs: targets are data.
#pragma once

#include <array>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace berth::host {

// Lengths in millimetres, in the target frame: origin at the ring's centre on the plate's front
// face, x right, y down, z into the plate; a raised dot has negative z.

struct Ring {
  double outer = 0;
  double inner = 0;
};

struct Line {
  std::array<double, 2> center{};
  double length = 0;
  double width = 0;
  double angle_deg = 0;  ///< from x towards y
};

struct Dot {
  std::string name;
  std::array<double, 3> center{};
  double radius = 0;
  double collar_radius = 0;  ///< disc in the plate's colour around the dot at its z; 0 = none
  double post_radius = 0;    ///< cylinder from the plate to the collar; 0 = none
};

struct Target {
  std::string name;
  std::array<double, 2> plate_size_mm{};
  bool white_on_black = true;  ///< false: black markers on a white plate
  Ring ring;
  Line line;
  std::vector<Dot> dots;
};

/// Reads a target; the error is one line that names the file, the key and the cure.
tl::expected<Target, std::string> load_target(const std::string& path);

/// The same from text in memory; `name` stands for the file in error lines.
tl::expected<Target, std::string> parse_target(const std::string& text, const std::string& name);

/// CT-1, built into the program.
Target default_target();

}  // namespace berth::host
