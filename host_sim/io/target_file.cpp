#include "host_sim/io/target_file.hpp"

#include <cmath>

#include "host_sim/io/default_files.hpp"
#include "host_sim/io/yaml_text.hpp"

namespace berth::host {
namespace {

using Status = tl::expected<void, std::string>;

constexpr size_t kFewestDots = 3;
constexpr size_t kMostDots = 16;

// Collects the first error of a row of reads, so that a section reads as a list of its keys.
class Section {
 public:
  Section(const YamlText& yaml, const cv::FileNode& node, std::string title)
      : yaml_(yaml), node_(node), title_(std::move(title)) {}

  double positive(const std::string& key) {
    const double value = number(key);
    if (status_ && !(value > 0.0)) fail(key, "must be above zero");
    return value;
  }

  double number(const std::string& key) { return take(read_number(yaml_, node_, key), 0.0); }

  double optional_number(const std::string& key) {
    return node_.isMap() && !node_[key].empty() ? number(key) : 0.0;
  }

  double optional_length(const std::string& key) {
    const double value = optional_number(key);
    if (status_ && value < 0.0) fail(key, "must not be negative");
    return value;
  }

  template <size_t N>
  std::array<double, N> numbers(const std::string& key) {
    const auto list = take(read_numbers(yaml_, node_, key, N), std::vector<double>(N, 0.0));
    std::array<double, N> result{};
    std::copy(list.begin(), list.end(), result.begin());
    return result;
  }

  std::string text(const std::string& key) {
    return take(read_string(yaml_, node_, key), std::string());
  }

  void fail(const std::string& key, const std::string& problem) {
    if (status_) status_ = yaml_error(yaml_, title_ + key, problem);
  }

  void require(bool holds, const std::string& key, const std::string& problem) {
    if (!holds) fail(key, problem);
  }

  const Status& status() const { return status_; }

 private:
  template <typename T>
  T take(const tl::expected<T, std::string>& value, const T& otherwise) {
    if (value) return *value;
    // The reader names the bare key; the section's title goes before it.
    const std::string prefix = yaml_.name + ": ";
    if (status_)
      status_ = tl::make_unexpected(prefix + title_ + value.error().substr(prefix.size()));
    return otherwise;
  }

  const YamlText& yaml_;
  cv::FileNode node_;
  std::string title_;
  Status status_;
};

Status read_plate(const YamlText& yaml, Target& target) {
  Section top(yaml, yaml.storage.root(), "");
  target.name = top.text("name");
  target.plate_size_mm = top.numbers<2>("plate_size_mm");
  top.require(target.plate_size_mm[0] > 0.0 && target.plate_size_mm[1] > 0.0, "plate_size_mm",
              "must be above zero");
  const std::string polarity = top.text("polarity");
  top.require(polarity == "white_on_black" || polarity == "black_on_white", "polarity",
              "must be white_on_black or black_on_white");
  target.white_on_black = polarity == "white_on_black";
  return top.status();
}

Status read_ring(const YamlText& yaml, Target& target) {
  Section ring(yaml, yaml.storage["ring"], "ring.");
  target.ring.outer = ring.positive("outer_radius_mm");
  target.ring.inner = ring.positive("inner_radius_mm");
  ring.require(target.ring.inner < target.ring.outer, "inner_radius_mm",
               "must be smaller than outer_radius_mm");
  const double half = std::min(target.plate_size_mm[0], target.plate_size_mm[1]) / 2.0;
  ring.require(target.ring.outer <= half, "outer_radius_mm", "must lie on the plate");
  return ring.status();
}

// Half the extent of the line along x or y: its corners reach that far from its centre.
double half_extent(const Line& line, bool along_x) {
  const double angle = line.angle_deg * CV_PI / 180.0;
  const double c = std::abs(along_x ? std::cos(angle) : std::sin(angle));
  const double s = std::abs(along_x ? std::sin(angle) : std::cos(angle));
  return 0.5 * (line.length * c + line.width * s);
}

Status read_line(const YamlText& yaml, Target& target) {
  Section section(yaml, yaml.storage["line"], "line.");
  Line& line = target.line;
  line.center = section.numbers<2>("center_mm");
  line.length = section.positive("length_mm");
  line.width = section.positive("width_mm");
  line.angle_deg = section.optional_number("angle_deg");
  section.require(line.width < line.length, "width_mm", "must be smaller than length_mm");
  const double reach_x = std::abs(line.center[0]) + half_extent(line, true);
  const double reach_y = std::abs(line.center[1]) + half_extent(line, false);
  section.require(
      reach_x <= target.plate_size_mm[0] / 2.0 && reach_y <= target.plate_size_mm[1] / 2.0,
      "center_mm", "the line must lie on the plate");
  return section.status();
}

tl::expected<Dot, std::string> read_dot(const YamlText& yaml, const cv::FileNode& node,
                                        const Target& target, size_t index) {
  Section section(yaml, node, "dots[" + std::to_string(index) + "].");
  Dot dot;
  dot.name = section.text("name");
  dot.center = section.numbers<3>("center_mm");
  dot.radius = section.positive("radius_mm");
  dot.collar_radius = section.optional_length("collar_radius_mm");
  dot.post_radius = section.optional_length("post_radius_mm");
  section.require(dot.center[2] <= 0.0, "center_mm", "z must not be behind the plate (above 0)");
  section.require(std::abs(dot.center[0]) + dot.radius <= target.plate_size_mm[0] / 2.0 &&
                      std::abs(dot.center[1]) + dot.radius <= target.plate_size_mm[1] / 2.0,
                  "center_mm", "the dot must lie on the plate");
  section.require(dot.collar_radius == 0.0 || dot.collar_radius > dot.radius, "collar_radius_mm",
                  "must be larger than the dot");
  if (!section.status()) return tl::make_unexpected(section.status().error());
  return dot;
}

Status read_dots(const YamlText& yaml, Target& target) {
  const cv::FileNode list = yaml.storage["dots"];
  if (!list.isSeq() || list.size() < kFewestDots || list.size() > kMostDots) {
    return yaml_error(yaml, "dots", "must be a list of 3 to 16 dots");
  }
  for (size_t i = 0; i < list.size(); ++i) {
    const auto dot = read_dot(yaml, list[static_cast<int>(i)], target, i);
    if (!dot) return tl::make_unexpected(dot.error());
    for (const Dot& other : target.dots) {
      if (other.name == dot->name) {
        return yaml_error(yaml, "dots", "the name " + dot->name + " stands twice; rename one");
      }
    }
    target.dots.push_back(*dot);
  }
  return {};
}

}  // namespace

tl::expected<Target, std::string> parse_target(const std::string& text, const std::string& name) {
  const auto yaml = parse_yaml(text, name);
  if (!yaml) return tl::make_unexpected(yaml.error());
  Target target;
  const Status status = read_plate(*yaml, target)
                            .and_then([&] { return read_ring(*yaml, target); })
                            .and_then([&] { return read_line(*yaml, target); })
                            .and_then([&] { return read_dots(*yaml, target); });
  if (!status) return tl::make_unexpected(status.error());
  return target;
}

tl::expected<Target, std::string> load_target(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return tl::make_unexpected(text.error());
  return parse_target(*text, path);
}

Target default_target() { return parse_target(default_target_yaml(), "built-in target").value(); }

}  // namespace berth::host
