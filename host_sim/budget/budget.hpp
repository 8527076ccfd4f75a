// What the firmware needs of the chip, against the reference parts: the contents of
// docs/budgets.md.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host_sim/budget/call_graph.hpp"
#include "host_sim/budget/instruction_counts.hpp"
#include "host_sim/budget/modules.hpp"

namespace berth::host {

struct MemoryUse {
  std::uint64_t flash = 0, flash_bytes = 0;  // with the parameter block
  std::uint64_t ram = 0, ram_bytes = 0;
  std::uint64_t external = 0, external_bytes = 0;
};

struct Budget {
  MemoryUse memory;
  std::map<std::string, ModuleBytes> modules;
  std::vector<PlacedSection> variables;  // of 256 bytes and more
  StackPath application, handler;
  InstructionCounts envelope, adversarial;
  InstructionCounts tracked_near, tracked_far;  // 300 mm; beyond 800 mm
};

/// One line of the table that budgets are judged by.
struct Limit {
  std::string what, unit;
  double used = 0;
  double limit = 0;  // published: beyond it the check fails
  double goal = 0;   // of docs/budgets.md; 0: the limit is the goal
};
std::vector<Limit> limits_of(const Budget& budget);

/// The whole report, Markdown.
std::string budget_text(const Budget& budget);

}  // namespace berth::host
