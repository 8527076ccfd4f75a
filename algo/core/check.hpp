// Range checks: free in flight builds, fatal in the range-checking build.
//
// Every intermediate of the fixed-point code has a stated range. Built with BERTH_RANGE_CHECK=1 the
// statements below are executed and stop the program where one does not hold, so that the test
// suite is a proof over everything it touches. In flight builds they vanish.
#pragma once

#include <cstdint>

#ifndef BERTH_RANGE_CHECK
#define BERTH_RANGE_CHECK 0
#endif

namespace berth {

/// Called when a range statement does not hold; defined by the host program or the firmware.
[[noreturn]] void range_violation(const char* what);

#if BERTH_RANGE_CHECK
#define BERTH_RANGE(condition)                              \
  do {                                                      \
    if (!(condition)) ::berth::range_violation(#condition); \
  } while (false)
#else
#define BERTH_RANGE(condition) static_cast<void>(0)
#endif

/// Narrowing conversion whose range the caller has argued; proven in the range-checking build.
template <typename To, typename From>
constexpr To narrow(From value) {
  const To out = static_cast<To>(value);
#if BERTH_RANGE_CHECK
  if (static_cast<From>(out) != value || ((out < To{}) != (value < From{}))) {
    range_violation("narrow");
  }
#endif
  return out;
}

}  // namespace berth
