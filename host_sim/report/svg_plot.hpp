// Plots as inline SVG: scatter with linear or logarithmic axes, and bars.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace berth::host {

using PlotPoint = std::pair<double, double>;

/// Dots of one colour, or a line where `is_line`.
struct PlotSeries {
  std::string name;
  std::string color;  // as CSS has it
  std::vector<PlotPoint> points;
  bool is_line = false;
};

struct ScatterPlot {
  std::string title, x_label, y_label;
  bool log_y = true;
  std::vector<PlotSeries> series;
};

/// A plot of 520 x 340 units. Points that a logarithm cannot show lie on the lower border. Of more
/// than 4000 points in a series every n-th is drawn.
std::string to_svg(const ScatterPlot& plot);

struct Bar {
  std::string label;
  double value = 0;
  std::string text;  // written at its end
  std::string color;
};

struct BarPlot {
  std::string title, x_label;
  double full = 0;  // value of the longest bar; 0: the largest value
  std::vector<Bar> bars;
};

/// Horizontal bars, one below the other.
std::string to_svg(const BarPlot& plot);

}  // namespace berth::host
