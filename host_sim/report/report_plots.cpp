#include "host_sim/report/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "host_sim/report/svg_plot.hpp"

namespace berth::host {
namespace {

constexpr const char* kBlue = "#2563a8";
constexpr const char* kOrange = "#d9822b";
constexpr const char* kGrey = "#8a8f98";
constexpr const char* kRed = "#c02f2f";
constexpr double kRotationLimit_deg = 0.015;  // at 300 mm
constexpr double kTranslationLimit_mm = 0.2;

double limit_scale(double distance_mm) { return distance_mm * distance_mm / (300.0 * 300.0); }

using Coordinate = std::function<double(const Verdict&)>;

/// Judged poses in the colours of what they are worth.
std::vector<PlotSeries> error_series(const ReportData& data, const Coordinate& x,
                                     const Coordinate& y) {
  std::vector<PlotSeries> series = {{"not valid", kGrey, {}, false},
                                    {"valid", kOrange, {}, false},
                                    {"high precision", kBlue, {}, false},
                                    {"false", kRed, {}, false}};
  for (const ReportEntry& entry : data.entries) {
    const Verdict& v = entry.verdict;
    if (!entry.truth || !v.has_error) continue;
    const std::size_t kind = v.false_pose ? 3 : v.high_precision ? 2 : entry.record.valid() ? 1 : 0;
    series[kind].points.emplace_back(x(v), y(v));
  }
  return series;
}

bool has_points(const std::vector<PlotSeries>& series) {
  return std::any_of(series.begin(), series.end(),
                     [](const PlotSeries& s) { return !s.points.empty(); });
}

std::string over_distance(const ReportData& data, const char* title, const char* y_label,
                          const Coordinate& error, double limit_at_300) {
  ScatterPlot plot{title, "distance, mm", y_label, true, {}};
  plot.series = error_series(
      data, [](const Verdict& v) { return v.distance_mm; }, error);
  if (!has_points(plot.series)) return {};
  double low = 1e9, high = 0;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) {
      low = std::min(low, point.first);
      high = std::max(high, point.first);
    }
  }
  PlotSeries limit{"limit of high precision", "#222", {}, true};
  for (int i = 0; i <= 40; ++i) {
    const double distance = low + (high - low) * i / 40;
    limit.points.emplace_back(distance, limit_at_300 * limit_scale(distance));
  }
  plot.series.push_back(limit);
  return to_svg(plot);
}

std::string over_tilt(const ReportData& data, const char* title, const Coordinate& error,
                      double limit_at_300) {
  ScatterPlot plot{title, "tilt, deg", "error / limit", true, {}};
  const auto ratio = [&](const Verdict& v) {
    return error(v) / (limit_at_300 * limit_scale(v.distance_mm));
  };
  plot.series = error_series(
      data, [](const Verdict& v) { return v.tilt_deg; }, ratio);
  if (!has_points(plot.series)) return {};
  double high = 0;
  for (const PlotSeries& series : plot.series) {
    for (const PlotPoint& point : series.points) high = std::max(high, point.first);
  }
  plot.series.push_back({"limit", "#222", {{0, 1}, {high, 1}}, true});
  return to_svg(plot);
}

double rotation(const Verdict& v) { return v.rotation_deg; }
double translation(const Verdict& v) { return v.translation_mm; }

}  // namespace

std::string rotation_over_distance(const ReportData& data) {
  return over_distance(data, "Rotation error", "e_R, deg", rotation, kRotationLimit_deg);
}

std::string translation_over_distance(const ReportData& data) {
  return over_distance(data, "Translation error", "e_t, mm", translation, kTranslationLimit_mm);
}

std::string rotation_over_tilt(const ReportData& data) {
  return over_tilt(data, "Rotation error over its limit", rotation, kRotationLimit_deg);
}

std::string translation_over_tilt(const ReportData& data) {
  return over_tilt(data, "Translation error over its limit", translation, kTranslationLimit_mm);
}

std::string reasons_plot(const ReportData& data) {
  const Summary& s = data.summary;
  BarPlot plot{"Outcomes", "", static_cast<double>(s.frames), {}};
  const auto bar = [&](const std::string& name, std::size_t count, const char* color) {
    const double percent = 100.0 * static_cast<double>(count) /
                           static_cast<double>(std::max<std::size_t>(s.frames, 1));
    plot.bars.push_back(
        {name, static_cast<double>(count), fmt::format("{} ({:.1f} %)", count, percent), color});
  };
  bar("valid", s.valid, kBlue);
  for (const auto& [reason, count] : s.reasons) bar(reason, count, kOrange);
  return to_svg(plot);
}

std::string identification_plot(const ReportData& data, const std::string& title,
                                const std::string& column, const std::vector<double>& edges) {
  std::vector<Rate> rates(edges.size() - 1);
  for (const ReportEntry& entry : data.entries) {
    if (!entry.truth || !entry.verdict.has_target) continue;
    const auto value = entry.truth->number(column);
    if (!value) continue;
    const auto above = std::upper_bound(edges.begin(), edges.end() - 1, *value);
    const auto band = std::max<std::ptrdiff_t>(above - edges.begin() - 1, 0);
    rates[static_cast<std::size_t>(band)].add(entry.verdict.identified);
  }
  BarPlot plot{title, "", 100, {}};
  for (std::size_t i = 0; i < rates.size(); ++i) {
    if (rates[i].of == 0) continue;
    plot.bars.push_back({fmt::format("{:g} to {:g}", edges[i], edges[i + 1]), rates[i].percent(),
                         fmt::format("{:.1f} % of {}", rates[i].percent(), rates[i].of), kBlue});
  }
  return to_svg(plot);
}

std::string reference_plot(const ReportData& data) {
  PlotSeries rotation_series{"rotation", kBlue, {}, false};
  PlotSeries translation_series{"translation", kOrange, {}, false};
  double high = 0;
  for (const ReportEntry& entry : data.entries) {
    const ReferenceComparison& r = entry.reference;
    if (!r.is_compared) continue;
    const double distance = r.pose->translation_mm.norm();
    high = std::max(high, distance);
    rotation_series.points.emplace_back(distance, r.rotation_deg / r.combined_rotation_deg);
    translation_series.points.emplace_back(distance, r.translation_mm / r.combined_translation_mm);
  }
  if (rotation_series.points.empty()) return {};
  double low = high;
  for (const PlotPoint& point : rotation_series.points) low = std::min(low, point.first);
  const PlotSeries limit{"three sigma", "#222", {{low, 3}, {high, 3}}, true};
  return to_svg(ScatterPlot{"Difference to OpenCV's pose",
                            "distance, mm",
                            "difference / combined sigma",
                            true,
                            {rotation_series, translation_series, limit}});
}

}  // namespace berth::host
