// The host's answer to a broken range statement: say which one, and stop.
#include <cstdio>
#include <cstdlib>

#include "core/check.hpp"

void berth::range_violation(const char* what) {
  std::fprintf(stderr, "range violation: %s\n", what);
  std::abort();
}
