// Many random poses through P3P and selection: failures, and fixed-point error against double.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace berth::test {

struct P3pCampaign {
  std::int64_t poses = 0;
  std::int64_t failures = 0;      // no pose, or beyond 1 deg or 1 % of the distance
  std::int64_t above_tenth = 0;   // fixed-point error above a tenth of the clean bound
  std::int64_t twin_missing = 0;  // the twin did not converge
  double worst_rotation_deg = 0, worst_translation_ratio = 0;
  double worst_twin_ratio = 0;      // of the bound
  std::vector<std::string> listed;  // the failures
};

struct P3pConditions {
  double noise_px = 0;
  double scale = 1;             // of CT-1; 0: log-uniform 0.25 to 4
  bool has_distortion = false;  // HEC-1's
  bool all_triples = true;      // false: the default limits, which stop early
};

P3pCampaign run_p3p_campaign(std::int64_t count, std::uint64_t seed,
                             const P3pConditions& conditions);

}  // namespace berth::test
