// Campaigns: frames rendered in memory, run through the flight code, judged, counted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/campaign/frame_maker.hpp"

namespace berth::host {

struct CampaignOptions {
  CampaignSet set = CampaignSet::kEnvelope;
  uint64_t count = 0;  ///< 0: the set's own size
  uint64_t seed = 0;
  int jobs = 1;
  std::string out;  ///< folder for frames.csv (the checkpoint), misses.csv, summary.txt; or empty
  std::string photos = "/usr/share/wallpapers";
  std::string camera, target;    ///< files; empty: HEC-1, CT-1
  std::vector<uint64_t> frames;  ///< only these, as pictures
  std::string pictures;          ///< folder for them
  bool check = false;            ///< exit 1 where a goal is missed
};

/// Runs or resumes the campaign and prints its tables to standard output; what is wrong goes to
/// standard error in one line. Returns the exit code.
int run_campaign(const CampaignOptions& options);

}  // namespace berth::host
