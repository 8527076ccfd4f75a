#include "host_sim/campaign/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host_sim/report/summary.hpp"

namespace berth::host {
namespace {

/// One class of frames under one aspect.
struct Bin {
  std::string name;
  std::vector<bool> members;  // by row
};

struct Aspect {
  std::string title;
  std::vector<Bin> bins;
};

/// What is counted of some frames.
struct Counts {
  Rate identified, high_precision;
  size_t valid = 0, false_identifications = 0, false_poses = 0;

  void add(const FrameTable& table, size_t row) {
    identified.add(table.flag(row, "identified"));
    high_precision.add(table.flag(row, "high_precision"));
    valid += table.flag(row, "valid");
    false_identifications += table.flag(row, "false_identification");
    false_poses += table.flag(row, "false_pose");
  }
};

template <typename Predicate>
Bin make_bin(const FrameTable& table, std::string name, Predicate is_member) {
  Bin bin{std::move(name), std::vector<bool>(table.size())};
  for (size_t row = 0; row < table.size(); ++row) bin.members[row] = is_member(row);
  return bin;
}

Aspect by_number(const FrameTable& table, const std::string& title, const std::string& column,
                 const std::vector<double>& edges) {
  Aspect aspect{title, {}};
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    const std::string name = fmt::format("{:g} .. {:g}", edges[i], edges[i + 1]);
    aspect.bins.push_back(make_bin(table, name, [&](size_t row) {
      const auto value = table.number(row, column);
      return value && *value >= edges[i] && *value < edges[i + 1];
    }));
  }
  return aspect;
}

Aspect by_text(const FrameTable& table, const std::string& title, const std::string& column) {
  std::map<std::string, bool> values;
  for (size_t row = 0; row < table.size(); ++row) values[table.text(row, column)] = true;
  Aspect aspect{title, {}};
  for (const auto& [value, seen] : values) {
    const std::string wanted = value;
    aspect.bins.push_back(make_bin(table, wanted.empty() ? "none" : wanted,
                                   [&](size_t row) { return table.text(row, column) == wanted; }));
  }
  return aspect;
}

std::vector<Aspect> target_aspects(const FrameTable& table) {
  return {
      by_number(table, "distance, mm", "distance_mm", {0, 400, 550, 750, 1050, 1e6}),
      by_number(table, "tilt, deg", "tilt_deg", {0, 10, 20, 30, 40, 45, 50, 55, 90}),
      by_number(table, "contrast, DN", "contrast_dn", {0, 31, 45, 60, 90, 130, 1e3}),
      by_number(table, "defocus, px", "defocus_px", {0, 0.8, 1.2, 1.6, 2.1}),
      by_number(table, "motion, px", "motion_px", {0, 1.5, 3, 4.5, 6.1}),
      by_number(table, "noise, DN", "noise_dn", {0, 1.5, 3, 4.5, 6.1}),
      by_number(table, "white, DN", "white_dn", {0, 80, 160, 255, 1e3}),
      by_number(table, "light gradient", "gradient_ratio", {0, 1.0001, 2, 5}),
      by_number(table, "light left in the shadow", "shadow_leaves", {0, 0.5, 0.999, 2}),
      by_text(table, "glint", "glint"),
      by_text(table, "hidden", "hidden"),
      by_text(table, "background", "background"),
  };
}

Counts count(const FrameTable& table, const std::vector<bool>& members) {
  Counts counts;
  for (size_t row = 0; row < table.size(); ++row) {
    if (members[row]) counts.add(table, row);
  }
  return counts;
}

std::string interval(const Rate& rate) {
  return fmt::format("{:6.2f} ({:5.2f} .. {:6.2f})", rate.percent(), rate.low_percent(),
                     rate.high_percent());
}

std::string count_line(const std::string& name, const Counts& c) {
  return fmt::format("  {:<26} {:>6}  {}   {}  {:>5} {:>5}\n", name, c.identified.of,
                     interval(c.identified), interval(c.high_precision), c.false_identifications,
                     c.false_poses);
}

std::string count_header(const std::string& title) {
  return fmt::format("\n  {:<26} {:>6}  {:<24}   {:<24}  {:>5} {:>5}\n", title, "frames",
                     "identified % (95 %)", "high precision % (95 %)", "f.id", "f.pose");
}

std::string aspect_text(const FrameTable& table, const Aspect& aspect) {
  std::string out = count_header(aspect.title);
  for (const Bin& bin : aspect.bins) {
    const Counts counts = count(table, bin.members);
    if (counts.identified.of > 0) out += count_line(bin.name, counts);
  }
  return out;
}

// Two aspects at a time: where do misses meet?
std::string weakest_corners(const FrameTable& table, const std::vector<Aspect>& aspects) {
  constexpr size_t kLeastFrames = 25, kShown = 10;
  std::vector<std::pair<std::string, Counts>> corners;
  for (size_t a = 0; a < aspects.size(); ++a) {
    for (size_t b = a + 1; b < aspects.size(); ++b) {
      for (const Bin& p : aspects[a].bins) {
        for (const Bin& q : aspects[b].bins) {
          std::vector<bool> both = p.members;
          for (size_t row = 0; row < both.size(); ++row) both[row] = both[row] && q.members[row];
          const Counts counts = count(table, both);
          if (counts.identified.of < kLeastFrames) continue;
          if (counts.identified.hits == counts.identified.of) continue;
          corners.emplace_back(
              fmt::format("{} {} and {} {}", aspects[a].title, p.name, aspects[b].title, q.name),
              counts);
        }
      }
    }
  }
  std::stable_sort(corners.begin(), corners.end(), [](const auto& x, const auto& y) {
    return x.second.identified.high_percent() < y.second.identified.high_percent();
  });
  if (corners.empty()) return {};
  std::string out = "\n  weakest corners (pairs of at least 25 frames)\n";
  for (size_t i = 0; i < std::min(kShown, corners.size()); ++i) {
    const Rate& rate = corners[i].second.identified;
    out += fmt::format("  {:<58} {:>4} of {:>4}  {}\n", corners[i].first, rate.hits, rate.of,
                       interval(rate));
  }
  return out;
}

template <typename Predicate>
std::string reasons_text(const FrameTable& table, const char* title, Predicate is_member) {
  std::map<std::string, size_t> reasons;
  for (size_t row = 0; row < table.size(); ++row) {
    if (is_member(row)) ++reasons[table.text(row, "reason")];
  }
  if (reasons.empty()) return {};
  std::string out = fmt::format("\n  {}\n", title);
  for (const auto& [reason, number] : reasons) {
    out += fmt::format("    {:<24} {:>6}\n", reason.empty() ? "(valid)" : reason, number);
  }
  return out;
}

std::string target_text(const FrameTable& table) {
  std::string out;
  const std::vector<Aspect> aspects = target_aspects(table);
  for (const Aspect& aspect : aspects) out += aspect_text(table, aspect);
  out += weakest_corners(table, aspects);
  out += reasons_text(table, "not identified", [&](size_t row) {
    return !table.flag(row, "identified") && !table.flag(row, "false_identification");
  });
  out += reasons_text(table, "identified, no valid pose", [&](size_t row) {
    return table.flag(row, "identified") && !table.flag(row, "valid");
  });
  return out;
}

std::string empty_line(const FrameTable& table, const Bin& bin) {
  const Counts c = count(table, bin.members);
  if (c.identified.of == 0) return {};
  return fmt::format("  {:<26} {:>6} {:>11} {:>7}\n", bin.name, c.identified.of,
                     c.false_identifications, c.false_poses);
}

std::string empty_text(const FrameTable& table) {
  std::string out;
  for (const Aspect& aspect :
       {by_text(table, "kind", "kind"),
        by_number(table, "change in the image, px", "shift_px", {0.001, 0.5, 1, 2, 4, 8, 1e4})}) {
    out += fmt::format("\n  {:<26} {:>6} {:>11} {:>7}\n", aspect.title, "frames", "identified",
                       "valid");
    for (const Bin& bin : aspect.bins) out += empty_line(table, bin);
  }
  return out + reasons_text(table, "reasons", [](size_t) { return true; });
}

std::string rate_text(const char* name, const Rate& rate) {
  return fmt::format("  {:<26} {}  {} of {}\n", name, interval(rate), rate.hits, rate.of);
}

}  // namespace

CampaignGoal goal_of(CampaignSet set) {
  switch (set) {
    case CampaignSet::kEnvelope:
      return {"envelope", 20000, 99.7};
    case CampaignSet::kSteep:
      return {"steep", 5000, 97.0};
    case CampaignSet::kHidden:
      return {"hidden", 5000, 99.0};
    case CampaignSet::kEmpty:
      break;
  }
  return {"empty", 10000, 0.0};
}

bool is_goal_reached(const FrameTable& table, CampaignSet set) {
  const Counts all = count(table, std::vector<bool>(table.size(), true));
  return all.false_identifications == 0 && all.false_poses == 0 &&
         (set == CampaignSet::kEmpty || all.identified.percent() >= goal_of(set).identified_pc);
}

std::string campaign_text(const FrameTable& table, CampaignSet set) {
  const Counts all = count(table, std::vector<bool>(table.size(), true));
  const CampaignGoal goal = goal_of(set);
  Rate false_identified{all.false_identifications, table.size()};
  Rate false_pose{all.false_poses, table.size()};
  std::string out = fmt::format("{}: {} frames{:<8} rate % (95 %)\n", goal.name, table.size(), "");
  if (set != CampaignSet::kEmpty) {
    out += rate_text("target identified", all.identified);
    out += fmt::format("  {:<26} {:6.2f}\n", "  goal", goal.identified_pc);
    out += rate_text("high-precision poses", all.high_precision);
    out += rate_text("valid poses", Rate{all.valid, table.size()});
  }
  out += rate_text("false identifications", false_identified);
  out += rate_text("false poses", false_pose);
  return out + (set == CampaignSet::kEmpty ? empty_text(table) : target_text(table));
}

std::vector<size_t> missed_rows(const FrameTable& table, CampaignSet set) {
  std::vector<size_t> rows;
  for (size_t row = 0; row < table.size(); ++row) {
    const bool is_missed = set != CampaignSet::kEmpty && !table.flag(row, "identified");
    if (is_missed || table.flag(row, "false_identification") || table.flag(row, "false_pose")) {
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace berth::host
