// Figures of a replay: rates with their intervals, quantiles, worst frames.
#include "host_sim/report/summary.hpp"

#include <gtest/gtest.h>

#include "host_sim/report/report_data.hpp"

namespace berth::host {
namespace {

TEST(Rate, WilsonInterval) {
  // Newcombe 1998, table I: 81 of 263 and 0 of 20, 95 % score intervals without correction.
  Rate rate{81, 263};
  EXPECT_NEAR(rate.low_percent(), 25.53, 0.01);
  EXPECT_NEAR(rate.high_percent(), 36.62, 0.01);
  rate = {0, 20};
  EXPECT_NEAR(rate.low_percent(), 0.0, 0.01);
  EXPECT_NEAR(rate.high_percent(), 16.11, 0.01);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantile({1, 2, 3, 4}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({1, 2}, 1), 2);
  EXPECT_DOUBLE_EQ(quantile({}, 0.5), 0);
}

FrameRecord record_of(std::uint32_t index, bool valid, Reason reason) {
  FrameRecord record;
  record.pose.frame_index = index;
  record.pose.valid = record.pose.has_pose = record.pose.identified = valid;
  record.pose.reason = reason;
  return record;
}

TEST(Summary, CountsReasonsOfWhatIsNotValid) {
  Summary summary;
  summary.add(record_of(0, true, Reason::kNone));
  summary.add(record_of(1, false, Reason::kNoLine));
  summary.add(record_of(2, false, Reason::kBadFrame));
  EXPECT_EQ(summary.frames, 3u);
  EXPECT_EQ(summary.valid, 1u);
  EXPECT_EQ(summary.bad_frames, 1u);
  EXPECT_EQ(summary.reasons.at("no_line"), 1u);
  EXPECT_EQ(summary.reasons.count(""), 0u);
}

TEST(Summary, TargetFreeFramesCountForFalsePosesOnly) {
  Summary summary;
  Verdict verdict;
  verdict.false_pose = verdict.false_identification = true;
  summary.add(record_of(0, true, Reason::kNone), verdict);
  EXPECT_EQ(summary.without_target, 1u);
  EXPECT_EQ(summary.false_poses, 1u);
  EXPECT_EQ(summary.identification.of, 0u);
  EXPECT_EQ(summary.high_precision.of, 0u);
}

TEST(Summary, EasyRateIsOfIdentifiedEasyFrames) {
  Summary summary;
  Verdict verdict;
  verdict.has_target = verdict.is_easy = true;
  summary.add(record_of(0, false, Reason::kNoCircle), verdict);  // missed
  verdict.identified = verdict.high_precision = true;
  summary.add(record_of(1, true, Reason::kNone), verdict);
  EXPECT_EQ(summary.high_precision_easy.of, 1u);
  EXPECT_EQ(summary.high_precision_easy.hits, 1u);
  EXPECT_EQ(summary.identification_easy.of, 2u);
  EXPECT_EQ(summary.high_precision.of, 2u);
}

TEST(WorstFrames, KeepsTheWorstInOrderWhateverTheOrderOfArrival) {
  const cv::Mat image(4, 4, CV_8UC1, cv::Scalar(0));
  WorstFrames forwards, backwards;
  for (std::uint32_t i = 0; i < 40; ++i) {
    ReportEntry entry{record_of(i, true, Reason::kNone), {}, {}, {}};
    entry.record.pose.residual_px = Px::from_raw(static_cast<int>(i % 7 + 1) << 10);
    forwards.offer(entry, image);
    entry.record.pose.frame_index = 39 - i;
    entry.record.pose.residual_px = Px::from_raw(static_cast<int>((39 - i) % 7 + 1) << 10);
    backwards.offer(entry, image);
  }
  const auto a = forwards.take();
  const auto b = backwards.take();
  ASSERT_EQ(a.size(), 12u);
  ASSERT_EQ(b.size(), 12u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].entry.record.pose.frame_index, b[i].entry.record.pose.frame_index);
    EXPECT_LE(a[i].badness, a[i > 0 ? i - 1 : 0].badness);
  }
}

}  // namespace
}  // namespace berth::host
