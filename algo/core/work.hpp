// The work of a frame, counted as it goes: the same on every platform, so that a deadline is.
//
// Each stage counts what it loops over (cells, edge pixels, steps of a walk, pixels looked at by a
// fit, plates, dots, poses) times what one of them costs the Cortex-M7, in steps of about one
// instruction; the factors stand beside the loops and are checked against counted instructions
// (tests/budget/test_work.cpp). A unit is a thousand steps.
#pragma once

#include <cstdint>

#include "core/check.hpp"

namespace berth {

constexpr std::uint32_t kStepsPerUnit = 1000;
constexpr std::int32_t kMaxBudget_units = 1000000;

class Work {
 public:
  /// Without a limit.
  Work() = default;
  explicit Work(std::int32_t budget_units) { set_budget(budget_units); }

  /// 0..kMaxBudget_units. A budget that was spent and is now larger is not spent any more.
  void set_budget(std::int32_t units) {
    BERTH_RANGE(units >= 0 && units <= kMaxBudget_units);
    limit_ = static_cast<std::uint32_t>(units) * kStepsPerUnit;
    is_refused_ = false;
  }

  /// Work that has been done.
  void spend(std::uint32_t steps) { done_ = steps < kNoLimit - done_ ? done_ + steps : kNoLimit; }

  /// Work to be done now, whose cost is known: false, and the budget is spent, where it does not
  /// fit.
  bool take(std::uint32_t steps) {
    if (!affords(steps)) is_refused_ = true;
    if (is_spent()) return false;
    spend(steps);
    return true;
  }

  bool affords(std::uint32_t steps) const { return steps <= left(); }
  bool is_spent() const { return is_refused_ || done_ >= limit_; }
  std::uint32_t left() const { return done_ < limit_ ? limit_ - done_ : 0; }
  std::uint32_t units() const { return done_ / kStepsPerUnit; }

 private:
  static constexpr std::uint32_t kNoLimit = 0xffffffffu;
  std::uint32_t done_ = 0, limit_ = kNoLimit;
  bool is_refused_ = false;
};

}  // namespace berth
