#include "host_sim/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace berth::host {
namespace {

/// One side of Wilson's 95 % interval of a rate.
double wilson_percent(const Rate& rate, double z) {
  if (rate.of == 0) return 0.0;
  const double n = static_cast<double>(rate.of);
  const double p = static_cast<double>(rate.hits) / n;
  const double middle = p + z * z / (2 * n);
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return 100.0 * (middle + half) / (1 + z * z / n);
}

std::string rate_line(const char* name, const Rate& rate) {
  if (rate.of == 0) return {};
  // A negative z gives the lower side: the half width changes its sign with it.
  return fmt::format("  {:<44} {:>6.2f} %  ({} of {}, 95 %: {:.2f} to {:.2f})\n", name,
                     rate.percent(), rate.hits, rate.of, rate.low_percent(), rate.high_percent());
}

std::string count_line(const char* name, std::size_t count) {
  return fmt::format("  {:<44} {:>6}\n", name, count);
}

std::string band_lines(const Summary& summary) {
  std::string out;
  for (const Band& band : summary.bands) {
    if (band.rotation_deg.empty()) continue;
    const std::string to = band.to_mm < 1e6 ? fmt::format("{:.0f}", band.to_mm) : "";
    out += fmt::format("  {:>4.0f} .. {:<4} {:>6} {:>11.5f} {:>9.5f} {:>11.4f} {:>9.4f} {:>7.2f}\n",
                       band.from_mm, to, band.rotation_deg.size(), quantile(band.rotation_deg, 0.5),
                       quantile(band.rotation_deg, 0.95), quantile(band.translation_mm, 0.5),
                       quantile(band.translation_mm, 0.95), mean(band.nees) / 6);
  }
  if (out.empty()) return out;
  return "  distance mm   valid  deg median      95 %   mm median      95 %  NEES/6\n" + out;
}

std::string axes_line(const char* name, const Eigen::Vector3d& worst, const char* unit) {
  return fmt::format("  {:<44} {:>8.5f} {:>8.5f} {:>8.5f} {}\n", name, worst[0], worst[1], worst[2],
                     unit);
}

/// What the emulated board needed.
std::string target_lines(const Summary& s) {
  if (s.instructions.empty()) return {};
  return fmt::format("  {:<44} {:>6.2f} M median, {:.2f} M worst\n", "instructions per frame",
                     quantile(s.instructions, 0.5) / 1e6, quantile(s.instructions, 1) / 1e6) +
         fmt::format("  {:<44} {:>6} bytes\n", "stack peak", s.stack_peak_bytes);
}

}  // namespace

double Rate::low_percent() const { return wilson_percent(*this, -1.96); }
double Rate::high_percent() const { return wilson_percent(*this, 1.96); }

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

double instructions_of(const PlatformPacket& platform, std::uint32_t ticks) {
  return platform.ticks_hz == 0 ? 0.0 : 1e9 * ticks / platform.ticks_hz;
}

double mean(const std::vector<double>& values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Summary::Summary() {
  const std::vector<double> edges = {0, 350, 500, 700, 1000, 1e9};
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    bands.push_back({edges[i], edges[i + 1], {}, {}, {}});
  }
}

void Summary::add(const FrameRecord& record) {
  ++frames;
  identified += record.identified();
  valid += record.valid();
  bad_frames += record.reason() == Reason::kBadFrame;
  if (record.platform && record.reason() != Reason::kBadFrame) {
    instructions.push_back(instructions_of(*record.platform, record.platform->frame_ticks));
    stack_peak_bytes = std::max(stack_peak_bytes, record.platform->stack_peak_bytes);
  }
  if (!record.valid()) ++reasons[reason_name(record.reason())];
}

void Summary::add(const FrameRecord& record, const Verdict& verdict) {
  ++judged;
  false_poses += verdict.false_pose;
  false_identifications += verdict.false_identification;
  ++(verdict.has_target ? with_target : without_target);
  if (!verdict.has_target) return;
  identification.add(verdict.identified);
  high_precision.add(verdict.high_precision);
  if (verdict.is_easy) identification_easy.add(verdict.identified);
  if (verdict.identified) high_precision_found.add(verdict.high_precision);
  if (verdict.identified && verdict.is_easy) high_precision_easy.add(verdict.high_precision);
  if (!record.valid() || !verdict.has_error) return;
  worst_rotation_deg = worst_rotation_deg.cwiseMax(verdict.rotation_axes_deg.cwiseAbs());
  worst_translation_mm = worst_translation_mm.cwiseMax(verdict.translation_axes_mm.cwiseAbs());
  for (Band& band : bands) {
    if (verdict.distance_mm < band.from_mm || verdict.distance_mm >= band.to_mm) continue;
    band.rotation_deg.push_back(verdict.rotation_deg);
    band.translation_mm.push_back(verdict.translation_mm);
    if (verdict.nees) band.nees.push_back(*verdict.nees);
  }
}

std::string summary_text(const Summary& s) {
  std::string out = count_line("frames", s.frames);
  if (s.bad_frames != 0) out += count_line("unreadable or of the wrong size", s.bad_frames);
  out += count_line("identified (as reported)", s.identified);
  out += count_line("valid poses", s.valid);
  for (const auto& [reason, count] : s.reasons) out += count_line(("  " + reason).c_str(), count);
  out += target_lines(s);
  if (s.judged == 0) return out;
  out += rate_line("target identified", s.identification);
  out += rate_line("target identified, easy frames", s.identification_easy);
  out += rate_line("high-precision poses, all frames", s.high_precision);
  out += rate_line("high-precision poses, identified frames", s.high_precision_found);
  out += rate_line("high-precision poses, identified easy frames", s.high_precision_easy);
  out += count_line("false poses", s.false_poses);
  out += count_line("false identifications", s.false_identifications);
  if (s.valid != 0 && s.with_target != 0) {
    out += axes_line("largest rotation error, x y z", s.worst_rotation_deg, "deg");
    out += axes_line("largest translation error, x y z", s.worst_translation_mm, "mm");
  }
  if (s.identification_easy.of != 0) {
    out += "  (easy: contrast >= 60 DN, noise <= 3 DN, nothing hidden)\n";
  }
  return out + band_lines(s);
}

}  // namespace berth::host
