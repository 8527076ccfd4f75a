#include "host_sim/report/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/report/html_text.hpp"

namespace berth::host {
namespace {

constexpr double kWidth = 520, kHeight = 340;
constexpr double kLeft = 68, kRight = 20, kTop = 34, kBottom = 62;
constexpr std::size_t kMostPoints = 4000;

struct Axis {
  double low = 0, high = 1;
  bool log = false;
  double from = 0, to = 1;  // screen
  double step = 0;          // between ticks, of a linear axis

  double operator()(double value) const {
    const double clipped = std::clamp(value, low, high);
    const double share =
        log ? std::log(clipped / low) / std::log(high / low) : (clipped - low) / (high - low);
    return from + share * (to - from);
  }
};

std::string text_at(double x, double y, const char* anchor, const std::string& text,
                    const char* style = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y,
                     anchor, style, escape_html(text));
}

std::string line_at(double x1, double y1, double x2, double y2, const char* css) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n", x1, y1, x2,
      y2, css);
}

/// 1, 2, 2.5 or 5 times a power of ten, so that about `wanted` steps make the span.
double nice_step(double span, int wanted) {
  const double raw = span / wanted;
  const double decade = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 2.5, 5.0}) {
    if (raw <= factor * decade) return factor * decade;
  }
  return 10 * decade;
}

Axis linear_axis(double low, double high, double from, double to) {
  if (!(high > low)) high = low + 1;
  const double step = nice_step(high - low, 6);
  return {std::floor(low / step) * step, std::ceil(high / step) * step, false, from, to, step};
}

/// Whole decades, six at most: the far tail of tiny errors lies on the border.
Axis log_axis(double low, double high, double from, double to) {
  const double top = std::ceil(std::log10(high));
  const double bottom = std::clamp(std::floor(std::log10(low)), top - 6, top - 1);
  return {std::pow(10, bottom), std::pow(10, top), true, from, to, 0};
}

std::string ticks_x(const Axis& x, const Axis& y) {
  std::string out;
  for (double v = x.low; v <= x.high + x.step / 2; v += x.step) {
    out += line_at(x(v), y.from, x(v), y.to, "grid");
    out += text_at(x(v), y.from + 16, "middle", fmt::format("{:g}", std::round(v * 1e6) / 1e6));
  }
  return out;
}

std::string ticks_y(const Axis& x, const Axis& y) {
  std::string out;
  for (double v = y.low; v <= y.high * 1.0001; v = y.log ? v * 10 : v + y.step) {
    out += line_at(x.from, y(v), x.to, y(v), "grid");
    out += text_at(x.from - 6, y(v) + 4, "end", fmt::format("{:.3g}", v));
  }
  return out;
}

std::string draw(const PlotSeries& series, const Axis& x, const Axis& y) {
  std::string out;
  if (series.is_line) {
    out = fmt::format(
        "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"6 3\" "
        "points=\"",
        series.color);
    for (const auto& [px, py] : series.points) out += fmt::format("{:.1f},{:.1f} ", x(px), y(py));
    return out + "\"/>\n";
  }
  out = fmt::format("<g fill=\"{}\" fill-opacity=\"0.6\">", series.color);
  const std::size_t stride = series.points.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < series.points.size(); i += stride) {
    const auto& [px, py] = series.points[i];
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.1\"/>", x(px), y(py));
  }
  return out + "</g>\n";
}

std::string legend(const std::vector<PlotSeries>& series) {
  std::string out;
  double x = kLeft;
  for (const PlotSeries& s : series) {
    if (s.points.empty()) continue;
    const double y = kHeight - 10;
    out +=
        fmt::format(s.is_line ? "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\" "
                                "stroke=\"{3}\" stroke-width=\"1.6\" stroke-dasharray=\"6 3\"/>"
                              : "<circle cx=\"{4:.1f}\" cy=\"{1:.1f}\" r=\"4\" fill=\"{3}\"/>",
                    x, y - 4, x + 18, s.color, x + 9);
    out += text_at(x + 23, y, "start", s.name);
    x += 34 + 6.2 * static_cast<double>(s.name.size());
  }
  return out;
}

std::string open_svg(double height, const std::string& title) {
  return fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, height,
                     escape_html(title)) +
         text_at(kLeft, 20, "start", title, "class=\"title\"");
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return low > high; }
};

}  // namespace

std::string to_svg(const ScatterPlot& plot) {
  Extent extent_x, extent_y;
  for (const PlotSeries& series : plot.series) {
    for (const auto& [px, py] : series.points) {
      extent_x.add(px);
      if (!plot.log_y || py > 0) extent_y.add(py);
    }
  }
  if (extent_x.empty() || extent_y.empty()) return {};
  const Axis x = linear_axis(extent_x.low, extent_x.high, kLeft, kWidth - kRight);
  const double from = kHeight - kBottom;
  const Axis y = plot.log_y ? log_axis(extent_y.low, extent_y.high, from, kTop)
                            : linear_axis(std::min(0.0, extent_y.low), extent_y.high, from, kTop);
  std::string out = open_svg(kHeight, plot.title) + ticks_x(x, y) + ticks_y(x, y);
  for (const PlotSeries& series : plot.series) out += draw(series, x, y);
  out += text_at((x.from + x.to) / 2, from + 33, "middle", plot.x_label);
  const double middle = (y.from + y.to) / 2;
  const std::string turn = fmt::format("transform=\"rotate(-90 14 {:.1f})\"", middle);
  out += text_at(14, middle, "middle", plot.y_label, turn.c_str());
  return out + legend(plot.series) + "</svg>\n";
}

std::string to_svg(const BarPlot& plot) {
  if (plot.bars.empty()) return {};
  constexpr double kRow = 24, kLabel = 150, kText = 124;  // kText: "100.0 % of 20000"
  double full = plot.full;
  for (const Bar& bar : plot.bars) full = plot.full > 0 ? full : std::max(full, bar.value);
  const double height = kTop + kRow * static_cast<double>(plot.bars.size()) + 12;
  std::string out = open_svg(height, plot.title);
  for (std::size_t i = 0; i < plot.bars.size(); ++i) {
    const Bar& bar = plot.bars[i];
    const double top = kTop + kRow * static_cast<double>(i);
    const double width =
        full > 0 ? (kWidth - kLabel - kText) * std::min(1.0, bar.value / full) : 0.0;
    out += text_at(kLabel - 8, top + 14, "end", bar.label);
    out += fmt::format(
        "<rect x=\"{}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"17\" rx=\"2\" fill=\"{}\"/>\n",
        kLabel, top, std::max(width, 1.0), bar.color);
    out += text_at(kLabel + width + 6, top + 14, "start", bar.text);
  }
  return out + "</svg>\n";
}

}  // namespace berth::host
