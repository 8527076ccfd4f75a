// Target and mount files: what is accepted, and one clear line for what is not.
#include <gtest/gtest.h>

#include "host_sim/io/default_files.hpp"
#include "host_sim/io/mount_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "tests/render/text_edit.hpp"

namespace berth::host {
namespace {

std::string good() { return default_target_yaml(); }

void expect_refused(const std::string& text, const std::string& key, const std::string& word) {
  const auto target = parse_target(text, "t.yaml");
  ASSERT_FALSE(target) << key;
  EXPECT_EQ(target.error().rfind("t.yaml: " + key, 0), 0u) << target.error();
  EXPECT_NE(target.error().find(word), std::string::npos) << target.error();
  EXPECT_EQ(target.error().find('\n'), std::string::npos) << target.error();
}

TEST(TargetFile, DefaultIsCt1) {
  const Target t = default_target();
  EXPECT_EQ(t.name, "ct1");
  EXPECT_TRUE(t.white_on_black);
  EXPECT_EQ(t.plate_size_mm[0], 120.0);
  EXPECT_EQ(t.ring.outer, 30.0);
  EXPECT_EQ(t.ring.inner, 24.0);
  EXPECT_EQ(t.line.center[1], 45.0);
  EXPECT_EQ(t.line.length, 56.0);
  EXPECT_EQ(t.line.width, 6.0);
  ASSERT_EQ(t.dots.size(), 5u);
  EXPECT_EQ(t.dots[0].name, "D0");
  EXPECT_EQ(t.dots[0].center[2], -20.0);
  EXPECT_EQ(t.dots[0].collar_radius, 9.0);
  EXPECT_EQ(t.dots[0].post_radius, 3.0);
  EXPECT_EQ(t.dots[4].name, "D4");
  EXPECT_EQ(t.dots[4].collar_radius, 0.0);
}

TEST(TargetFile, FlatTargetHasNoRaisedDot) {
  const auto target = load_target(BERTH_DATA_FOLDER "/target_ct1f.yaml");
  ASSERT_TRUE(target) << target.error();
  EXPECT_EQ(target->name, "ct1f");
  ASSERT_EQ(target->dots.size(), 4u);
  for (const Dot& dot : target->dots) EXPECT_EQ(dot.center[2], 0.0);
}

TEST(TargetFile, AcceptsTheOtherPolarity) {
  const auto target = parse_target(with(good(), "white_on_black", "black_on_white"), "t.yaml");
  ASSERT_TRUE(target);
  EXPECT_FALSE(target->white_on_black);
}

TEST(TargetFile, RefusesMissingKeys) {
  expect_refused(without_line(good(), "name: ct1"), "name", "is missing");
  expect_refused(without_line(good(), "plate_size_mm"), "plate_size_mm", "is missing");
  expect_refused(without_line(good(), "polarity"), "polarity", "is missing");
  expect_refused(without_line(good(), "ring:"), "ring.outer_radius_mm", "is missing");
  expect_refused(without_line(good(), "line:"), "line.center_mm", "is missing");
  expect_refused(with(good(), "radius_mm: 6., collar", "collar"), "dots[0].radius_mm",
                 "is missing");
  expect_refused(with(good(), "dots:", "spots:"), "dots", "must be a list");
}

TEST(TargetFile, RefusesBadValues) {
  expect_refused(with(good(), "white_on_black", "red"), "polarity", "black_on_white");
  expect_refused(with(good(), "[ 120., 120. ]", "[ 120. ]"), "plate_size_mm", "2 numbers");
  expect_refused(with(good(), "[ 120., 120. ]", "[ 120., -1. ]"), "plate_size_mm", "above zero");
  expect_refused(with(good(), "inner_radius_mm: 24.", "inner_radius_mm: 31."),
                 "ring.inner_radius_mm", "smaller");
  expect_refused(with(good(), "outer_radius_mm: 30.", "outer_radius_mm: 70."),
                 "ring.outer_radius_mm", "on the plate");
  expect_refused(with(good(), "outer_radius_mm: 30.", "outer_radius_mm: x"), "ring.outer_radius_mm",
                 "must be a number");
  expect_refused(with(good(), "length_mm: 56.", "length_mm: 0."), "line.length_mm", "above zero");
  expect_refused(with(good(), "angle_deg: 0.", "angle_deg: 90."), "line.center_mm", "on the plate");
  expect_refused(with(good(), "[ -45., -45., 0. ]", "[ -45., -45., 3. ]"), "dots[1].center_mm",
                 "behind the plate");
  expect_refused(with(good(), "[ -45., -45., 0. ]", "[ -58., -45., 0. ]"), "dots[1].center_mm",
                 "on the plate");
  expect_refused(with(good(), "collar_radius_mm: 9.", "collar_radius_mm: 5."),
                 "dots[0].collar_radius_mm", "larger than the dot");
  expect_refused(with(good(), "name: D4", "name: D3"), "dots", "stands twice");
}

std::string mount_text(const std::string& key, const std::string& data) {
  return "%YAML:1.0\n---\n" + key + ": !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n" +
         "   data: [ " + data + " ]\n";
}

TEST(MountFile, ReadsOneTransformAndLeavesTheOtherIdentity) {
  const auto mount = parse_mount(
      mount_text("T_TL", "0., -1., 0., 5., 1., 0., 0., 6., 0., 0., 1., 7., 0., 0., 0., 1."),
      "m.yaml");
  ASSERT_TRUE(mount) << mount.error();
  EXPECT_EQ(mount->T_EC, Eigen::Matrix4d::Identity());
  EXPECT_EQ(mount->T_TL(0, 1), -1.0);
  EXPECT_EQ(mount->T_TL(2, 3), 7.0);
}

TEST(MountFile, RefusesWhatIsNoRigidTransform) {
  const auto refusal = [](const std::string& text) {
    const auto mount = parse_mount(text, "m.yaml");
    return mount ? std::string("accepted") : mount.error();
  };
  const std::string scaled =
      refusal(mount_text("T_EC", "2., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1."));
  EXPECT_EQ(scaled.rfind("m.yaml: T_EC: its rotation", 0), 0u) << scaled;
  const std::string mirrored = refusal(
      mount_text("T_EC", "-1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1."));
  EXPECT_NE(mirrored.find("right-handed"), std::string::npos) << mirrored;
  const std::string row =
      refusal(mount_text("T_EC", "1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 1., 1."));
  EXPECT_NE(row.find("last row"), std::string::npos) << row;
  EXPECT_NE(refusal("%YAML:1.0\n---\nT_XX: 1\n").find("both missing"), std::string::npos);
  EXPECT_NE(refusal("%YAML:1.0\n---\nT_EC: 1\n").find("opencv-matrix"), std::string::npos);
}

}  // namespace
}  // namespace berth::host
