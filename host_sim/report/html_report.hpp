// The report of a replay: one HTML file that needs nothing else.
#pragma once

#include <string>

#include "host_sim/report/report_data.hpp"

namespace berth::host {

std::string html_report(const ReportData& data);

}  // namespace berth::host
