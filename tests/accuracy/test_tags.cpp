// The chain against fiducial tags on the same plate, on a few images.
#include <gtest/gtest.h>

#include "accuracy/tag_campaign.hpp"

namespace berth::accuracy {
namespace {

TEST(Tags, OursIsMorePreciseThanEveryReaderOfATag) {
  if (BERTH_RANGE_CHECK) GTEST_SKIP() << "a comparison, measured on the plain build";
  Ledger ledger;
  const Rig rig = make_rig(false);
  for (const double distance : {300.0, 1500.0}) {
    for (const TiltBand& tilt : {TiltBand{0, 10}, TiltBand{25, 40}}) {
      const auto scores = compare_readers(rig, tilt, distance, 3, ledger);
      EXPECT_EQ(scores[0].missed, 0);
      for (size_t r = 1; r < scores.size(); ++r) {
        ASSERT_LT(scores[r].missed, 2) << scores[r].name;
        EXPECT_LT(scores[0].rotation_deg, scores[r].rotation_deg) << scores[r].name << distance;
        EXPECT_LT(scores[0].translation_mm, scores[r].translation_mm) << scores[r].name << distance;
      }
    }
  }
}

}  // namespace
}  // namespace berth::accuracy
