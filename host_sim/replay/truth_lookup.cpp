#include "host_sim/replay/truth_lookup.hpp"

namespace berth::host {

namespace fs = std::filesystem;

namespace {

fs::path folder_key(const fs::path& folder) {
  return fs::weakly_canonical(folder.empty() ? fs::path(".") : folder);
}

}  // namespace

tl::expected<TruthLookup, std::string> TruthLookup::open(const std::string& file,
                                                         const std::vector<fs::path>& folders) {
  TruthLookup lookup;
  if (!file.empty()) {
    auto truth = load_truth(file);
    if (!truth) return tl::unexpected(truth.error());
    lookup.named_ = std::move(*truth);
    lookup.has_named_ = true;
    return lookup;
  }
  for (const fs::path& folder : folders) {
    const fs::path beside = folder / "truth.csv";
    if (!fs::exists(beside)) continue;
    auto truth = load_truth(beside);
    if (!truth) return tl::unexpected(truth.error());
    lookup.by_folder_[folder_key(folder)] = std::move(*truth);
  }
  return lookup;
}

const TruthRow* TruthLookup::find(const fs::path& path) const {
  const Truth* truth = &named_;
  if (!has_named_) {
    const auto folder = by_folder_.find(folder_key(path.parent_path()));
    if (folder == by_folder_.end()) return nullptr;
    truth = &folder->second;
  }
  const auto row = truth->find(path.filename().string());
  return row == truth->end() ? nullptr : &row->second;
}

}  // namespace berth::host
