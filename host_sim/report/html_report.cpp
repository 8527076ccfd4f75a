#include "host_sim/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "host_sim/report/html_text.hpp"
#include "host_sim/report/report_plots.hpp"

namespace berth::host {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; color: #1f2430;
       background: #f6f7f9; margin: 0; }
main { max-width: 1120px; margin: 0 auto; padding: 28px 24px 60px; }
h1 { font-size: 25px; margin: 0 0 2px; } h2 { font-size: 18px; margin: 34px 0 10px; }
p.note { color: #5b6270; margin: 4px 0 12px; font-size: 13.5px; }
.tiles { display: flex; flex-wrap: wrap; gap: 12px; margin: 18px 0 6px; }
.tile { background: #fff; border: 1px solid #e2e5ea; border-radius: 8px; padding: 12px 16px;
        min-width: 150px; flex: 1; box-sizing: border-box; }
.tile b { display: block; font-size: 23px; font-variant-numeric: tabular-nums; }
.tile span { color: #5b6270; font-size: 13px; }
.tile.bad b { color: #c02f2f; } .tile.good b { color: #1c7d45; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(440px, 1fr)); gap: 14px; }
.plots > div { background: #fff; border: 1px solid #e2e5ea; border-radius: 8px; padding: 8px; }
svg { width: 100%; height: auto; display: block; font: 12px system-ui, Arial, sans-serif; }
svg text { fill: #3a4150; } svg .title { font-size: 14px; font-weight: 600; fill: #1f2430; }
svg .grid { stroke: #e6e8ec; stroke-width: 1; }
table { border-collapse: collapse; background: #fff; border: 1px solid #e2e5ea; width: 100%;
        font-variant-numeric: tabular-nums; font-size: 14px; }
th, td { padding: 5px 12px; border-bottom: 1px solid #eceef1; text-align: right; }
th { background: #f0f2f5; font-weight: 600; } th:first-child, td:first-child { text-align: left; }
.worst { display: grid; grid-template-columns: repeat(auto-fill, minmax(340px, 1fr)); gap: 14px; }
.worst figure { margin: 0; background: #fff; border: 1px solid #e2e5ea; border-radius: 8px;
                overflow: hidden; }
.worst img { width: 100%; display: block; }
.worst figcaption { padding: 8px 12px; font-size: 13px; overflow-wrap: anywhere; }
)";

std::string section(const std::string& title, const std::string& note, const std::string& body) {
  if (body.empty()) return {};
  const std::string shown = note.empty() ? "" : "<p class=\"note\">" + escape_html(note) + "</p>\n";
  return "<h2>" + escape_html(title) + "</h2>\n" + shown + body;
}

std::string tile(const std::string& value, const std::string& name, const char* kind = "") {
  return fmt::format("<div class=\"tile {}\"><b>{}</b><span>{}</span></div>\n", kind, value,
                     escape_html(name));
}

std::string rate_tile(const Rate& rate, const std::string& name) {
  if (rate.of == 0) return {};
  return tile(fmt::format("{:.2f} %", rate.percent()),
              fmt::format("{} ({} of {}; 95 %: {:.2f} to {:.2f})", name, rate.hits, rate.of,
                          rate.low_percent(), rate.high_percent()));
}

std::string tiles(const Summary& s) {
  std::string out = tile(fmt::format("{}", s.frames), "frames");
  if (s.judged == 0) {
    out += tile(fmt::format("{}", s.identified), "identified");
    return "<div class=\"tiles\">" + out + tile(fmt::format("{}", s.valid), "valid poses") +
           "</div>\n";
  }
  out += rate_tile(s.identification, "target identified");
  out += rate_tile(s.high_precision, "high precision, all frames");
  out += rate_tile(s.high_precision_easy, "high precision, identified easy frames");
  out += tile(fmt::format("{}", s.false_poses), "false poses", s.false_poses ? "bad" : "good");
  out += tile(fmt::format("{}", s.false_identifications), "false identifications",
              s.false_identifications ? "bad" : "good");
  return "<div class=\"tiles\">" + out + "</div>\n";
}

std::string plots(const std::vector<std::string>& svgs) {
  std::string out;
  for (const std::string& svg : svgs) {
    if (!svg.empty()) out += "<div>" + svg + "</div>\n";
  }
  return out.empty() ? out : "<div class=\"plots\">\n" + out + "</div>\n";
}

std::string band_table(const Summary& s) {
  std::vector<std::vector<std::string>> rows;
  for (const Band& band : s.bands) {
    if (band.rotation_deg.empty()) continue;
    rows.push_back({band.to_mm > 1e6 ? fmt::format("from {:.0f} mm", band.from_mm)
                                     : fmt::format("{:.0f} to {:.0f} mm", band.from_mm, band.to_mm),
                    fmt::format("{}", band.rotation_deg.size()),
                    fmt::format("{:.5f}", quantile(band.rotation_deg, 0.5)),
                    fmt::format("{:.5f}", quantile(band.rotation_deg, 0.95)),
                    fmt::format("{:.5f}", quantile(band.rotation_deg, 1)),
                    fmt::format("{:.4f}", quantile(band.translation_mm, 0.5)),
                    fmt::format("{:.4f}", quantile(band.translation_mm, 0.95)),
                    fmt::format("{:.4f}", quantile(band.translation_mm, 1)),
                    fmt::format("{:.2f}", mean(band.nees) / 6)});
  }
  if (rows.empty()) return {};
  return html_table({"distance", "valid poses", "e_R median, deg", "95 %", "worst",
                     "e_t median, mm", "95 %", "worst", "NEES / 6"},
                    rows);
}

using Count = std::function<double(const FrameRecord&)>;

/// A row "name, median, 95 %, worst" over the frames that the chain has seen.
std::vector<std::string> count_row(const ReportData& data, const std::string& name,
                                   const Count& count) {
  std::vector<double> values;
  for (const ReportEntry& entry : data.entries) {
    if (entry.record.reason() != Reason::kBadFrame) values.push_back(count(entry.record));
  }
  const auto cell = [&](double q) { return fmt::format("{:.0f}", quantile(values, q)); };
  return {name, cell(0.5), cell(0.95), cell(1)};
}

std::string tally_table(const ReportData& data) {
  const auto tally = [](auto field) {
    return [field](const FrameRecord& r) { return double(r.algorithm.tally.*field); };
  };
  const std::vector<std::pair<const char*, Count>> counts = {
      {"edge pixels", tally(&FrameTally::edge_pixels)},
      {"edge chains", tally(&FrameTally::chains)},
      {"isophote votes", tally(&FrameTally::votes)},
      {"circle candidates", tally(&FrameTally::circle_candidates)},
      {"ellipses confirmed", tally(&FrameTally::ellipses)},
      {"dots located", tally(&FrameTally::dots_located)},
      {"pose candidates", tally(&FrameTally::pose_candidates)},
      {"noise, DN / 256", tally(&FrameTally::noise_q8)},
      {"work units", [](const FrameRecord& r) { return double(r.algorithm.work_units); }}};
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, count] : counts) rows.push_back(count_row(data, name, count));
  return html_table({"per frame", "median", "95 %", "most"}, rows);
}

std::string instruction_table(const ReportData& data) {
  if (!data.on_target) return {};
  std::vector<std::vector<std::string>> rows;
  for (int s = 0; s < kStageCount; ++s) {
    rows.push_back(count_row(data, stage_name(static_cast<Stage>(s)), [s](const FrameRecord& r) {
      return r.platform ? instructions_of(*r.platform, r.platform->stage_ticks[s]) : 0.0;
    }));
  }
  rows.push_back(count_row(data, "whole frame", [](const FrameRecord& r) {
    return r.platform ? instructions_of(*r.platform, r.platform->frame_ticks) : 0.0;
  }));
  rows.push_back(count_row(data, "stack peak, bytes", [](const FrameRecord& r) {
    return r.platform ? double(r.platform->stack_peak_bytes) : 0.0;
  }));
  return html_table({"instructions", "median", "95 %", "most"}, rows);
}

std::string caption(const WorstFrame& frame) {
  const FrameRecord& record = frame.entry.record;
  const Verdict& v = frame.entry.verdict;
  std::string out = "<b>" + escape_html(record.file) + "</b>: ";
  out += record.valid() ? "valid" : reason_name(record.reason());
  if (v.false_pose) out += ", <b>false pose</b>";
  if (v.false_identification) out += ", <b>false identification</b>";
  if (frame.entry.truth && v.has_target) {
    out += fmt::format("<br>{:.0f} mm, tilt {:.1f} deg", v.distance_mm, v.tilt_deg);
    for (const auto& [column, unit] :
         {std::pair("contrast_dn", "contrast {:.0f} DN"), std::pair("noise_dn", "noise {:.1f} DN"),
          std::pair("motion_px", "motion {:.1f} px"), std::pair("defocus_px", "blur {:.1f} px")}) {
      const auto value = frame.entry.truth->number(column);
      if (value) out += ", " + fmt::format(fmt::runtime(unit), *value);
    }
    const std::string hidden = frame.entry.truth->text("hidden");
    if (!hidden.empty()) out += ", hidden: " + escape_html(hidden);
  }
  if (v.has_error) {
    out += fmt::format("<br>e_R {:.5f} deg, e_t {:.4f} mm", v.rotation_deg, v.translation_mm);
  }
  const ReferenceComparison& r = frame.entry.reference;
  if (r.is_compared) {
    out += fmt::format("<br>to OpenCV: {:.5f} deg ({:.1f} sigma), {:.4f} mm ({:.1f} sigma)",
                       r.rotation_deg, r.rotation_deg / r.combined_rotation_deg, r.translation_mm,
                       r.translation_mm / r.combined_translation_mm);
  }
  return out;
}

std::string gallery(const ReportData& data) {
  std::string out;
  for (const WorstFrame& frame : data.worst) {
    out += fmt::format("<figure><img alt=\"{}\" src=\"{}\"><figcaption>{}</figcaption></figure>\n",
                       escape_html(frame.entry.record.file), jpeg_url(frame.picture, 760),
                       caption(frame));
  }
  return out.empty() ? out : "<div class=\"worst\">\n" + out + "</div>\n";
}

std::string reference_section(const ReportData& data) {
  if (!data.with_reference) return {};
  std::size_t ours = 0, theirs = 0, both = 0, apart = 0;
  std::vector<double> rotation_deg, translation_mm, their_rotation_deg, their_translation_mm;
  for (const ReportEntry& entry : data.entries) {
    const ReferenceComparison& r = entry.reference;
    ours += entry.record.valid();
    theirs += r.pose.has_value();
    both += r.is_compared;
    apart += r.disagrees();
    if (!entry.truth || !entry.truth->pose || !r.is_compared) continue;
    rotation_deg.push_back(entry.verdict.rotation_deg);
    translation_mm.push_back(entry.verdict.translation_mm);
    their_rotation_deg.push_back(rotation_error_deg(*r.pose, *entry.truth->pose));
    their_translation_mm.push_back(translation_error_mm(*r.pose, *entry.truth->pose));
  }
  const auto count = [](std::size_t n) { return fmt::format("{}", n); };
  std::vector<std::vector<std::string>> rows = {
      {"frames with a pose", count(ours), count(theirs)},
      {"frames with both; further apart than three sigma", count(both), count(apart)}};
  if (!rotation_deg.empty()) {
    const auto row = [&](const char* name, const auto& a, const auto& b, double q) {
      rows.push_back(
          {name, fmt::format("{:.5f}", quantile(a, q)), fmt::format("{:.5f}", quantile(b, q))});
    };
    row("rotation error, median, deg", rotation_deg, their_rotation_deg, 0.5);
    row("rotation error, 95 %, deg", rotation_deg, their_rotation_deg, 0.95);
    row("translation error, median, mm", translation_mm, their_translation_mm, 0.5);
    row("translation error, 95 %, mm", translation_mm, their_translation_mm, 0.95);
  }
  return html_table({"", "Berthmark (valid)", "OpenCV"}, rows) + plots({reference_plot(data)});
}

}  // namespace

std::string html_report(const ReportData& data) {
  const Summary& s = data.summary;
  const std::string intro = fmt::format(
      "Camera {}, target {}; the chain ran {}.{}", data.camera_name, data.target_name,
      data.on_target ? "as firmware on the emulated Cortex-M7" : "in the host simulator",
      data.interrupted ? " The run was interrupted." : "");
  std::string body = "<h1>" + escape_html(data.title) + "</h1>\n<p class=\"note\">" +
                     escape_html(intro) + "</p>\n" + tiles(s);
  if (s.identification_easy.of != 0) {
    body +=
        "<p class=\"note\">Easy frames: contrast of at least 60 DN, noise of at most 3 DN, "
        "nothing hidden.</p>\n";
  }
  body += section("Outcomes", "", plots({reasons_plot(data)}));
  body += section("Errors against the truth",
                  "High precision: e_R below 0.015 deg and e_t below 0.2 mm, times (distance / 300 "
                  "mm) squared.",
                  plots({rotation_over_distance(data), translation_over_distance(data),
                         rotation_over_tilt(data), translation_over_tilt(data)}));
  body += section("Errors by distance",
                  "Valid poses. NEES / 6 is the squared error in units of the reported covariance; "
                  "1 where the covariance tells the truth.",
                  band_table(s));
  body += section(
      "Identified frames", "",
      plots({identification_plot(data, "by distance, mm", "distance_mm",
                                 {300, 400, 550, 750, 1000, 1250, 1500}),
             identification_plot(data, "by tilt, deg", "tilt_deg", {0, 10, 20, 30, 40, 60}),
             identification_plot(data, "by contrast, DN", "contrast_dn",
                                 {0, 30, 45, 60, 90, 130, 255}),
             identification_plot(data, "by motion blur, px", "motion_px", {0, 1, 2, 3, 4, 5, 6})}));
  body += section("Beside OpenCV",
                  "An independent pipeline: contours, ellipse fits, sub-pixel edges, Gauss-Newton.",
                  reference_section(data));
  body += section("What the stages counted", "", tally_table(data));
  body += section("Instructions on the emulated Cortex-M7", "Counts, not times.",
                  instruction_table(data));
  body += section("Worst frames", "", gallery(data));
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
         escape_html(data.title) + "</title><style>" + kStyle + "</style></head><body><main>\n" +
         body + "</main></body></html>\n";
}

}  // namespace berth::host
