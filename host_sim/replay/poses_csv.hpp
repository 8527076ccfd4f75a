// The text outputs of a replay: poses CSV, markers CSV, TUM trajectory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "host_sim/report/frame_record.hpp"

namespace berth::host {

/// Header and rows of the poses CSV, without line ends: columns may follow.
std::string poses_csv_header();
/// A frame's row: 6 decimals for mm, pixels and ratios, 9 for quaternions and degrees; a field
/// without a value is empty.
std::string poses_csv_row(const FrameRecord& record);

/// Header line of the markers CSV: a line per marker, and per second pose of an ambiguous frame.
std::string markers_csv_header();
std::string markers_csv_rows(const FrameRecord& record);

/// A line "time tx ty tz qx qy qz qw" (s, m) of a valid pose, otherwise nothing. The time is the
/// frame's index times the period.
std::string tum_row(const FrameRecord& record, std::size_t index, std::uint32_t period_us);

/// A field as CSV has it: quoted where it holds a comma, a quote or a line end.
std::string csv_field(const std::string& text);

}  // namespace berth::host
