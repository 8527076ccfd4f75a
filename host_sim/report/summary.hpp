// A replay's figures: what was identified, what was valid, and what that was worth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host_sim/report/evaluate.hpp"
#include "host_sim/report/frame_record.hpp"

namespace berth::host {

/// A rate with its 95 % interval (Wilson 1927), per cent.
struct Rate {
  std::size_t hits = 0;
  std::size_t of = 0;

  void add(bool hit) { hits += hit, ++of; }
  double percent() const {
    return of == 0 ? 0.0 : 100.0 * static_cast<double>(hits) / static_cast<double>(of);
  }
  double low_percent() const;
  double high_percent() const;
};

/// Errors of one band of distances.
struct Band {
  double from_mm = 0, to_mm = 0;
  std::vector<double> rotation_deg, translation_mm, nees;
};

struct Summary {
  std::size_t frames = 0, identified = 0, valid = 0, bad_frames = 0;
  std::map<std::string, std::size_t> reasons;
  std::vector<double> instructions;    // per frame, of runs on target
  std::uint32_t stack_peak_bytes = 0;  // the same
  // The rest needs the truth.
  std::size_t judged = 0, with_target = 0, without_target = 0;
  Rate identification;        // of frames with a target
  Rate high_precision;        // of frames with a target
  Rate high_precision_found;  // of identified frames
  Rate high_precision_easy;   // of identified frames, easy scenes
  Rate identification_easy;   // of easy scenes
  std::size_t false_poses = 0, false_identifications = 0;
  std::vector<Band> bands;
  Eigen::Vector3d worst_rotation_deg = Eigen::Vector3d::Zero();  // per axis, valid poses
  Eigen::Vector3d worst_translation_mm = Eigen::Vector3d::Zero();

  Summary();
  void add(const FrameRecord& record);
  void add(const FrameRecord& record, const Verdict& verdict);
};

/// Instructions in a number of ticks: under QEMU's -icount shift=0 one is a nanosecond.
double instructions_of(const PlatformPacket& platform, std::uint32_t ticks);

/// The value below which the share q of the values lies (linear interpolation); 0 of nothing.
double quantile(std::vector<double> values, double q);
double mean(const std::vector<double>& values);

/// The table that `replay --summary` prints.
std::string summary_text(const Summary& summary);

}  // namespace berth::host
