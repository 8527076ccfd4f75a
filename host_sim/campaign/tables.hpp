// What a campaign's frames add up to, as text.
#pragma once

#include <string>
#include <vector>

#include "host_sim/campaign/frame_maker.hpp"
#include "host_sim/campaign/frame_table.hpp"

namespace berth::host {

/// What a set must reach.
struct CampaignGoal {
  const char* name;      ///< of the set
  size_t frames;         ///< its size
  double identified_pc;  ///< share identified; 0 for the empty set
};
CampaignGoal goal_of(CampaignSet set);

/// Whether the frames reach the goal: the rate itself, and nothing false.
bool is_goal_reached(const FrameTable& table, CampaignSet set);

/// All tables: rates with 95 % intervals (Wilson), broken down by what the scenes vary, the weakest
/// pairs of conditions, the reasons.
std::string campaign_text(const FrameTable& table, CampaignSet set);

/// Rows of frames that were missed, wrongly identified, or gave a false pose.
std::vector<size_t> missed_rows(const FrameTable& table, CampaignSet set);

}  // namespace berth::host
