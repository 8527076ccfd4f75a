// The truth of a replayed frame: from the truth.csv beside its image, or from a file that was
// named.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "host_sim/report/truth.hpp"

namespace berth::host {

class TruthLookup {
 public:
  /// Reads `file`, or where it is empty the truth.csv of each folder that has one.
  static tl::expected<TruthLookup, std::string> open(
      const std::string& file, const std::vector<std::filesystem::path>& folders);

  /// The truth of the image at `path`; null where there is none.
  const TruthRow* find(const std::filesystem::path& path) const;
  bool empty() const { return !has_named_ && by_folder_.empty(); }

 private:
  bool has_named_ = false;
  Truth named_;
  std::map<std::filesystem::path, Truth> by_folder_;
};

}  // namespace berth::host
