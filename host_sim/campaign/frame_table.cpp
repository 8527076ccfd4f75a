#include "host_sim/campaign/frame_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <sstream>

#include "host_sim/render/truth_csv.hpp"

namespace berth::host {
namespace {

namespace fs = std::filesystem;

const char* const kFirstColumns = "index,kind,amount,shift_px";
const char* const kLastColumns =
    "identified,false_identification,valid,high_precision,false_pose,reason,rank,dots,rings,"
    "noise_seen_dn,pools_full,ring_u_px,ring_v_px,ring_radius_px,seen_roll_deg,rotation_deg,"
    "translation_mm,nees";

// No field holds a comma.
std::vector<std::pair<size_t, size_t>> split(const std::string& line) {
  std::vector<std::pair<size_t, size_t>> fields;
  size_t begin = 0;
  for (size_t end; (end = line.find(',', begin)) != std::string::npos; begin = end + 1) {
    fields.emplace_back(begin, end - begin);
  }
  fields.emplace_back(begin, line.size() - begin);
  return fields;
}

// Columns of truth.csv without the file's name.
std::string scene_columns() { return truth_header().substr(truth_header().find(',') + 1); }

std::string scene_fields(const CampaignFrame& frame) {
  const std::string columns = scene_columns();
  if (frame.kind == "photo") {
    return std::string(static_cast<size_t>(std::count(columns.begin(), columns.end(), ',')), ',');
  }
  return truth_row("", frame.scene).substr(1);
}

std::string errors(const Verdict& verdict) {
  if (!verdict.has_error) return ",,";
  const std::string nees = verdict.nees ? fmt::format("{:.4f}", *verdict.nees) : std::string();
  return fmt::format("{:.7f},{:.6f},{}", verdict.rotation_deg, verdict.translation_mm, nees);
}

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string unwritable(const std::string& folder) {
  return folder + ": cannot be written; choose a folder with write permission and free space";
}

bool write(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

}  // namespace

FrameTable::FrameTable()
    : header_(fmt::format("{},{},{}", kFirstColumns, scene_columns(), kLastColumns)) {
  for (const auto& [begin, length] : split(header_)) {
    columns_.push_back(header_.substr(begin, length));
  }
}

bool FrameTable::add(const std::string& line) {
  Row row{line, split(line)};
  if (row.fields.size() != columns_.size()) return false;
  rows_.push_back(std::move(row));
  return true;
}

size_t FrameTable::index_of(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) throw std::logic_error("no column " + column);
  return static_cast<size_t>(found - columns_.begin());
}

std::string FrameTable::text(size_t row, const std::string& column) const {
  const auto& [begin, length] = rows_[row].fields[index_of(column)];
  return rows_[row].line.substr(begin, length);
}

std::optional<double> FrameTable::number(size_t row, const std::string& column) const {
  const std::string field = text(row, column);
  if (field.empty()) return std::nullopt;
  return std::strtod(field.c_str(), nullptr);
}

TruthRow truth_of(const CampaignFrame& frame) {
  TruthRow truth;
  const std::string columns = scene_columns(), values = scene_fields(frame);
  const auto names = split(columns), fields = split(values);
  for (size_t i = 0; i < names.size(); ++i) {
    truth.scene[columns.substr(names[i].first, names[i].second)] =
        values.substr(fields[i].first, fields[i].second);
  }
  if (frame.scene.has_target) {
    truth.pose = DoublePose{Eigen::Quaterniond(frame.scene.pose.R), frame.scene.pose.t};
  }
  return truth;
}

std::string frame_row(uint64_t index, const CampaignFrame& frame, const FrameRecord& record,
                      const Verdict& verdict) {
  const AlgorithmPacket& seen = record.algorithm;
  const FrameTally& tally = seen.tally;
  const bool is_identified = frame.scene.has_target ? verdict.identified : record.identified();
  return fmt::format(
      "{},{},{:.5f},{:.2f},{},{:d},{:d},{:d},{:d},{:d},{},{},{},{},{:.2f},{},{:.2f},{:.2f},{:.2f},"
      "{:.3f},{}",
      index, frame.kind, frame.amount, frame.shift_px, scene_fields(frame), is_identified,
      verdict.false_identification, record.valid(), verdict.high_precision, verdict.false_pose,
      reason_name(record.reason()), tally.identified_rank, tally.dots_located, tally.ellipses,
      tally.noise_q8 / 256.0, tally.pools_full, to_double(seen.ring_center_px[0]),
      to_double(seen.ring_center_px[1]), to_double(seen.ring_radius_px),
      to_double(seen.roll) * kDegreesPerRadian, errors(verdict));
}

tl::expected<Checkpoint, std::string> Checkpoint::open(const std::string& folder,
                                                       const std::string& identity,
                                                       FrameTable& table) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  const fs::path path = fs::path(folder) / "frames.csv";
  const fs::path identity_path = fs::path(folder) / "campaign.txt";
  if (fs::exists(path) && contents(identity_path) != identity) {
    return tl::unexpected(
        fmt::format("{}: holds another campaign (campaign.txt: set, seed, parameters or program "
                    "differ); choose another --out or remove it",
                    folder));
  }
  std::string kept = table.header() + '\n';
  std::istringstream lines(contents(path));
  std::string line;
  std::getline(lines, line);  // the header
  while (std::getline(lines, line) && !lines.eof() && table.add(line)) kept += line + '\n';
  if (!write(identity_path, identity) || !write(path, kept)) {
    return tl::unexpected(unwritable(folder));
  }
  Checkpoint checkpoint;
  checkpoint.file_.open(path, std::ios::binary | std::ios::app);
  if (!checkpoint.file_) return tl::unexpected(unwritable(folder));
  return checkpoint;
}

bool Checkpoint::append(const std::string& row) {
  file_ << row << '\n' << std::flush;
  return static_cast<bool>(file_);
}

}  // namespace berth::host
