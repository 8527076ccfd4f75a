// Which plots the report has; each function gives SVG, or nothing where there is nothing to plot.
#pragma once

#include <string>

#include "host_sim/report/report_data.hpp"

namespace berth::host {

/// Errors of the poses over distance, with the limit of a high-precision pose.
std::string rotation_over_distance(const ReportData& data);
std::string translation_over_distance(const ReportData& data);
/// Errors as multiples of that limit over the tilt.
std::string rotation_over_tilt(const ReportData& data);
std::string translation_over_tilt(const ReportData& data);
/// Why frames gave no valid pose.
std::string reasons_plot(const ReportData& data);
/// Identified frames by distance, tilt, contrast and noise.
std::string identification_plot(const ReportData& data, const std::string& title,
                                const std::string& column, const std::vector<double>& edges);
/// Differences to OpenCV's poses over distance, as multiples of the combined sigma.
std::string reference_plot(const ReportData& data);

}  // namespace berth::host
