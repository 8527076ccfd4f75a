// The text outputs: columns, decimals, empty fields.
#include <gtest/gtest.h>

#include "host_sim/replay/natural_order.hpp"
#include "host_sim/replay/poses_csv.hpp"
#include "program.hpp"

namespace berth::host {
namespace {

FrameRecord with_pose() {
  FrameRecord record;
  record.file = "a.png";
  PosePacket& p = record.pose;
  p.valid = p.identified = p.has_pose = true;
  p.reason = Reason::kNone;
  p.markers_used = 7;
  p.camera_from_target.translation_mm[0] = q<18>(1.5);
  p.camera_from_target.translation_mm[1] = Mm::from_raw(-1);  // -2^-18 mm
  p.camera_from_target.translation_mm[2] = q<18>(500.0);
  p.camera_from_target.rotation = {q<30>(0.5), q<30>(-0.5), q<30>(0.5), q<30>(-0.5)};
  p.covariance.sigma_rotation[0] = q<28>(0.001);
  p.residual_px = q<16>(0.25);
  return record;
}

std::string field(const std::string& row, const std::string& column) {
  const auto names = fields_of(poses_csv_header());
  const auto fields = fields_of(row);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == column) return fields.at(i);
  }
  return "no such column";
}

TEST(PosesCsv, ColumnsStandInTheirPlaces) {
  const auto names = fields_of(poses_csv_header());
  ASSERT_EQ(names.size(), 27u);
  EXPECT_EQ(names[0], "file");
  EXPECT_EQ(names[3], "tx_mm");
  EXPECT_EQ(names[6], "qw");
  EXPECT_EQ(names[10], "sigma_rx_deg");
  EXPECT_EQ(names[16], "residual_px");
  EXPECT_EQ(names[19], "identified");
  EXPECT_EQ(names[26], "eqz");
}

TEST(PosesCsv, EveryRowHasEveryField) {
  FrameRecord record;
  record.file = "bad.png";
  EXPECT_EQ(fields_of(poses_csv_row(record)).size(), 27u);
  EXPECT_EQ(fields_of(poses_csv_row(with_pose())).size(), 27u);
}

TEST(PosesCsv, DecimalsAndUnits) {
  const std::string row = poses_csv_row(with_pose());
  EXPECT_EQ(field(row, "tx_mm"), "1.500000");
  EXPECT_EQ(field(row, "ty_mm"), "-0.000004");  // 2^-18 = 3.81e-6
  EXPECT_EQ(field(row, "tz_mm"), "500.000000");
  EXPECT_EQ(field(row, "qx"), "-0.500000000");
  EXPECT_EQ(field(row, "sigma_rx_deg").substr(0, 8), "0.057295");  // 0.001 rad
  EXPECT_EQ(field(row, "residual_px"), "0.250000");
  EXPECT_EQ(field(row, "markers"), "7");
  EXPECT_EQ(field(row, "valid"), "1");
  EXPECT_EQ(field(row, "reason"), "");
}

TEST(PosesCsv, FieldsWithoutAValueAreEmpty) {
  FrameRecord record;
  record.file = "bad.png";
  const std::string row = poses_csv_row(record);
  EXPECT_EQ(field(row, "reason"), "bad_frame");
  EXPECT_EQ(field(row, "valid"), "0");
  EXPECT_EQ(field(row, "identified"), "0");
  for (const char* column : {"tx_mm", "qw", "sigma_tz_mm", "residual_px", "markers", "eqz"}) {
    EXPECT_EQ(field(row, column), "") << column;
  }
  EXPECT_EQ(field(poses_csv_row(with_pose()), "ambiguity"), "");  // no second pose
}

TEST(PosesCsv, InvalidPoseIsStillReported) {
  FrameRecord record = with_pose();
  record.pose.valid = false;
  record.pose.reason = Reason::kAmbiguous;
  record.pose.has_second = true;
  record.pose.ambiguity = q<30>(0.875);
  const std::string row = poses_csv_row(record);
  EXPECT_EQ(field(row, "reason"), "ambiguous");
  EXPECT_EQ(field(row, "tx_mm"), "1.500000");
  EXPECT_EQ(field(row, "ambiguity"), "0.875000");
}

TEST(PosesCsv, NamesWithCommasAreQuoted) {
  EXPECT_EQ(csv_field("a,b \"c\".png"), "\"a,b \"\"c\"\".png\"");
  EXPECT_EQ(csv_field("plain.png"), "plain.png");
}

TEST(MarkersCsv, EveryRowHasEveryField) {
  FrameRecord record = with_pose();
  record.pose.has_second = true;
  record.markers.set.count = 2;
  record.markers.set.markers[0].located = true;
  const auto columns = fields_of(lines_of(markers_csv_header()).at(0)).size();
  const auto rows = lines_of(markers_csv_rows(record));
  ASSERT_EQ(rows.size(), 3u);
  for (const std::string& row : rows) EXPECT_EQ(fields_of(row).size(), columns) << row;
  EXPECT_EQ(fields_of(rows[2]).at(1), "second_pose");
}

TEST(Tum, SecondsMetresAndScalarLast) {
  EXPECT_EQ(tum_row(with_pose(), 8, 125000).substr(0, 20), "1.000000 0.001500000");
  const std::string row = tum_row(with_pose(), 8, 125000);
  EXPECT_NE(row.find("-0.500000000 0.500000000 -0.500000000 0.500000000\n"), std::string::npos);
  FrameRecord invalid = with_pose();
  invalid.pose.valid = false;
  EXPECT_EQ(tum_row(invalid, 0, 125000), "");
}

TEST(NaturalOrder, NumbersCountAsNumbers) {
  EXPECT_TRUE(natural_less("img2.png", "img10.png"));
  EXPECT_FALSE(natural_less("img10.png", "img2.png"));
  EXPECT_TRUE(natural_less("a9b1", "a9b02"));
  EXPECT_TRUE(natural_less("img", "img0"));
  EXPECT_TRUE(natural_less("9999999999999999999998", "9999999999999999999999"));
}

TEST(NaturalOrder, IsStrictAndTotal) {
  EXPECT_FALSE(natural_less("a1", "a1"));
  EXPECT_NE(natural_less("img01", "img1"), natural_less("img1", "img01"));
}

}  // namespace
}  // namespace berth::host
