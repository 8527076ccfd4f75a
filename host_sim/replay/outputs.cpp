#include "host_sim/replay/outputs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iostream>

#include "host_sim/replay/poses_csv.hpp"

namespace berth::host {
namespace {

constexpr const char* kReferenceHeader =
    ",ref_tx_mm,ref_ty_mm,ref_tz_mm,ref_qw,ref_qx,ref_qy,ref_qz,ref_sigma_r_deg,ref_sigma_t_mm,"
    "diff_r_deg,diff_t_mm";

std::string reference_fields(const ReferenceComparison& r) {
  if (!r.pose) return ",,,,,,,,,,,";
  const Eigen::Vector3d& t = r.pose->translation_mm;
  const Eigen::Quaterniond& q = r.pose->rotation;
  const std::string pose =
      fmt::format(",{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f}", t.x(), t.y(),
                  t.z(), q.w(), q.x(), q.y(), q.z(), r.sigma_rotation_deg, r.sigma_translation_mm);
  if (!r.is_compared) return pose + ",,";
  return pose + fmt::format(",{:.9f},{:.6f}", r.rotation_deg, r.translation_mm);
}

/// Makes the folder where it is missing, and proves that a file can be written there.
bool make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path probe = std::filesystem::path(folder) / ".berthmark_probe";
  const bool writable = static_cast<bool>(std::ofstream(probe));
  std::filesystem::remove(probe, error);
  return writable;
}

}  // namespace

std::string unwritable(const std::string& path) {
  return fmt::format("{}: cannot be written; name a file in a folder that exists and is writable",
                     path);
}

tl::expected<Outputs::File, std::string> Outputs::open_file(const std::string& path) {
  File out;
  out.path = path;
  if (path == "-") {
    out.stream = &std::cout;
    return out;
  }
  out.file = std::make_unique<std::ofstream>(path, std::ios::binary | std::ios::trunc);
  if (!*out.file) return tl::unexpected(unwritable(path));
  out.stream = out.file.get();
  return out;
}

tl::expected<Outputs, std::string> Outputs::open(const ReplayOptions& options) {
  Outputs out;
  out.reference_ = options.reference;
  out.period_us_ = options.period_us;
  const bool silent = options.poses.empty() && options.markers.empty() && options.tum.empty() &&
                      options.overlay.empty() && options.report.empty() && !options.summary;
  const std::pair<File*, std::string> wanted[] = {{&out.poses_, silent ? "-" : options.poses},
                                                  {&out.markers_, options.markers},
                                                  {&out.tum_, options.tum}};
  for (const auto& [file, path] : wanted) {
    if (path.empty()) continue;
    auto opened = open_file(path);
    if (!opened) return tl::unexpected(opened.error());
    *file = std::move(*opened);
  }
  if (!options.overlay.empty() && !make_folder(options.overlay)) {
    return tl::unexpected(unwritable(options.overlay));
  }
  if (out.poses_.stream) {
    *out.poses_.stream << poses_csv_header() << (out.reference_ ? kReferenceHeader : "") << '\n';
  }
  if (out.markers_.stream) *out.markers_.stream << markers_csv_header();
  return out;
}

void Outputs::write(const FrameOutcome& outcome) {
  if (poses_.stream) {
    *poses_.stream << poses_csv_row(outcome.record)
                   << (reference_ ? reference_fields(outcome.reference) : "") << '\n';
  }
  if (markers_.stream) *markers_.stream << markers_csv_rows(outcome.record);
  if (tum_.stream) *tum_.stream << tum_row(outcome.record, outcome.index, period_us_);
}

tl::expected<void, std::string> Outputs::close() {
  for (File* file : {&poses_, &markers_, &tum_}) {
    if (file->stream && !file->stream->flush()) {
      return tl::unexpected(
          fmt::format("{}: could not be written to its end; make room on the disk", file->path));
    }
  }
  return {};
}

void Notes::say(const std::string& line) const {
  std::fprintf(stderr, "%sberthmark: %s\n", on_terminal ? "\r\033[K" : "", line.c_str());
}

void Notes::tell_problem(const FrameOutcome& outcome) {
  constexpr int kMostProblems = 20;
  ++problems_;
  if (problems_ <= kMostProblems) {
    say(fmt::format("{}: {}", outcome.record.file, outcome.problem));
  } else if (problems_ == kMostProblems + 1) {
    say("further images of this kind are marked bad_frame in the poses file");
  }
}

void Notes::tell(const FrameOutcome& outcome) {
  const std::string& file = outcome.record.file;
  if (!outcome.problem.empty()) tell_problem(outcome);
  if (outcome.conversions.from_16_bit && !said_16_bit_) {
    said_16_bit_ = true;
    say(fmt::format("{}: 16-bit image, divided by 257 to 8 bit (said once)", file));
  }
  if (outcome.conversions.from_color && !said_color_) {
    said_color_ = true;
    say(fmt::format("{}: colour image, converted to grey (said once)", file));
  }
}

}  // namespace berth::host
