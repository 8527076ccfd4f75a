// Every sweep gives its digest: on this compiler, with these options, as on the Arm target.
#include <gtest/gtest.h>

#include "sweeps.hpp"

namespace berth_test {
namespace {

TEST(Sweeps, GiveTheSameBitsOnEveryPlatform) {
  for (const Sweep& sweep : kSweeps) {
    EXPECT_EQ(sweep.run(), sweep.digest) << sweep.name << std::hex << " 0x" << sweep.run();
  }
}

}  // namespace
}  // namespace berth_test
