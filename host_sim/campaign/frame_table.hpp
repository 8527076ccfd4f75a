// A campaign's frames as a CSV table, which is also its checkpoint: one row per frame, in order.
#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/campaign/frame_maker.hpp"
#include "host_sim/report/evaluate.hpp"

namespace berth::host {

/// Rows of text under named columns.
class FrameTable {
 public:
  FrameTable();

  const std::string& header() const { return header_; }
  size_t size() const { return rows_.size(); }

  /// A row as frames.csv has it. False where its number of fields is wrong.
  bool add(const std::string& line);

  const std::string& line(size_t row) const { return rows_[row].line; }
  std::string text(size_t row, const std::string& column) const;
  /// Nothing where the field is empty.
  std::optional<double> number(size_t row, const std::string& column) const;
  bool flag(size_t row, const std::string& column) const { return text(row, column) == "1"; }

 private:
  struct Row {
    std::string line;
    std::vector<std::pair<size_t, size_t>> fields;  // begin and length in the line
  };
  size_t index_of(const std::string& column) const;

  std::string header_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// The scene's truth as `berthmark render` would have written it beside the image.
TruthRow truth_of(const CampaignFrame& frame);

/// The row of one processed frame.
std::string frame_row(uint64_t index, const CampaignFrame& frame, const FrameRecord& record,
                      const Verdict& verdict);

/// Rows on disk, added to as the campaign goes on.
class Checkpoint {
 public:
  /// Opens or begins `folder`/frames.csv and reads the rows that are there into `table`; a row that
  /// an interruption cut is dropped. `identity` says what the rows depend on; the error is one line
  /// when the folder holds another campaign's rows or cannot be written.
  static tl::expected<Checkpoint, std::string> open(const std::string& folder,
                                                    const std::string& identity, FrameTable& table);

  /// False where the disk is full.
  bool append(const std::string& row);

 private:
  std::ofstream file_;
};

}  // namespace berth::host
