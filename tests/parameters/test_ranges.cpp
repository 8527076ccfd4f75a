// Every value of the parameter block that is out of range is refused by name.
#include <gtest/gtest.h>

#include <functional>

#include "block_tools.hpp"

namespace berth::test {
namespace {

using Change = std::function<void(Parameters&)>;

struct Case {
  const char* field;
  Change change;
};

std::string refusal(const Change& change) {
  Parameters parameters = default_parameters();
  change(parameters);
  return decoded_text(encoded(parameters));
}

void expect_refusals(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    EXPECT_EQ(refusal(c.change), std::string("value out of range: ") + c.field);
  }
}

TEST(ParameterRanges, DefaultsAreAccepted) {
  EXPECT_EQ(refusal([](Parameters&) {}), "ok");
}

TEST(ParameterRanges, Camera) {
  expect_refusals({
      {"camera.width", [](auto& p) { p.camera.width = 1025; }},
      {"camera.height", [](auto& p) { p.camera.height = 0; }},
      {"camera.fx", [](auto& p) { p.camera.fx = Px(-1250); }},
      {"camera.fy", [](auto& p) { p.camera.fy = Px(0); }},
      {"camera.cx", [](auto& p) { p.camera.cx = Px::max(); }},
      {"camera.cy", [](auto& p) { p.camera.cy = Px::lowest(); }},
      {"camera.distortion", [](auto& p) { p.camera.k1 = Coefficient(-3); }},
  });
}

TEST(ParameterRanges, Target) {
  expect_refusals({
      {"target.plate_width_mm", [](auto& p) { p.target.plate_width_mm = Mm(29); }},
      {"target.plate_width_mm", [](auto& p) { p.target.plate_width_mm = Mm::lowest(); }},
      {"target.plate_height_mm", [](auto& p) { p.target.plate_height_mm = Mm(481); }},
      {"target.ring_outer_mm", [](auto& p) { p.target.ring_outer_mm = Mm(61); }},
      {"target.ring_outer_mm", [](auto& p) { p.target.ring_outer_mm = Mm::max(); }},
      {"target.ring_inner_mm", [](auto& p) { p.target.ring_inner_mm = Mm(30); }},
      {"target.ring_inner_mm", [](auto& p) { p.target.ring_inner_mm = Mm(0); }},
      {"target.line_x_mm", [](auto& p) { p.target.line_x_mm = Mm(-61); }},
      {"target.line_y_mm", [](auto& p) { p.target.line_y_mm = Mm(61); }},
      {"target.line_length_mm", [](auto& p) { p.target.line_length_mm = Mm(0); }},
      {"target.line_width_mm", [](auto& p) { p.target.line_width_mm = Mm(56); }},
      {"target.line_angle", [](auto& p) { p.target.line_angle = Angle(4); }},
  });
}

TEST(ParameterRanges, Dots) {
  expect_refusals({
      {"target.dot_count", [](auto& p) { p.target.dot_count = 2; }},
      {"target.dots[0].radius_mm", [](auto& p) { p.target.dots[0].radius_mm = Mm(0); }},
      {"target.dots[0].collar_radius_mm",
       [](auto& p) { p.target.dots[0].collar_radius_mm = Mm(5); }},
      {"target.dots[0].post_radius_mm", [](auto& p) { p.target.dots[0].post_radius_mm = Mm(10); }},
      {"target.dots[1].x_mm", [](auto& p) { p.target.dots[1].center_mm[0] = Mm(-55); }},
      {"target.dots[2].y_mm", [](auto& p) { p.target.dots[2].center_mm[1] = Mm::lowest(); }},
      {"target.dots[0].z_mm", [](auto& p) { p.target.dots[0].center_mm[2] = Mm(1); }},
      {"target.dots[3].z_mm", [](auto& p) { p.target.dots[3].center_mm[2] = Mm(-1); }},
      {"target.dots[4].center_mm",
       [](auto& p) { p.target.dots[4].center_mm = p.target.dots[3].center_mm; }},
      {"target.dots[1].center_mm",
       [](auto& p) {
         p.target.dots[1].center_mm = {Mm(20), Mm(20), Mm(0)};
       }},
  });
}

TEST(ParameterRanges, CollinearDots) {
  const auto align = [](Parameters& p) {
    p.target.dot_count = 3;
    for (int i = 0; i < 3; ++i) {
      p.target.dots[i] = {{Mm(-45), Mm(-45 + 20 * i), Mm(0)}, Mm(3), Mm(0), Mm(0)};
    }
  };
  expect_refusals({{"target.dots", align}});
  const auto nearly = [&](Parameters& p) {
    align(p);
    p.target.dots[1].center_mm[0] = Mm(-44);
  };
  expect_refusals({{"target.dots", nearly}});
  const auto triangle = [&](Parameters& p) {
    align(p);
    p.target.dots[1].center_mm[0] = Mm(-40);
  };
  EXPECT_EQ(refusal(triangle), "ok");
}

TEST(ParameterRanges, Mounts) {
  expect_refusals({
      {"mount.T_EC.rotation",
       [](auto& p) { p.effector_from_camera.rotation(0, 1) = q<30>(0.0001); }},
      {"mount.T_EC.rotation", [](auto& p) { p.effector_from_camera.rotation(2, 2) = Unit(-1); }},
      {"mount.T_TL.rotation", [](auto& p) { p.target_from_latch.rotation.fill(Unit::lowest()); }},
      {"mount.T_TL.rotation", [](auto& p) { p.target_from_latch.rotation.fill(Unit(0)); }},
      {"mount.T_EC.translation_mm[2]",
       [](auto& p) { p.effector_from_camera.translation_mm[2] = Mm(4001); }},
      {"mount.T_TL.translation_mm[0]",
       [](auto& p) { p.target_from_latch.translation_mm[0] = Mm::lowest(); }},
  });
}

TEST(ParameterRanges, Thresholds) {
  expect_refusals({
      {"thresholds.false_rotation", [](auto& p) { p.thresholds.false_rotation = Angle(0); }},
      {"thresholds.false_translation",
       [](auto& p) { p.thresholds.false_translation = q<24>(0.6); }},
      {"thresholds.ambiguity_ratio", [](auto& p) { p.thresholds.ambiguity_ratio = q<30>(1.1); }},
      {"thresholds.residual_sigmas", [](auto& p) { p.thresholds.residual_sigmas = q<16>(0.5); }},
      {"thresholds.edge_sigmas", [](auto& p) { p.thresholds.edge_sigmas = Q<16>::lowest(); }},
      {"thresholds.search_budget_units", [](auto& p) { p.thresholds.search_budget_units = -1; }},
      {"thresholds.frame_budget_units", [](auto& p) { p.thresholds.frame_budget_units = 1000001; }},
  });
}

TEST(ParameterRanges, DotCountsBeyondThePoolAreRefusedBeforeTheyAreUsed) {
  for (const std::uint32_t count : {9u, 1000000u, 0xFFFFFFFFu}) {
    std::vector<std::uint8_t> block = default_block();
    write_word(block, 112, count);
    seal(block);
    EXPECT_EQ(decoded_text(block), "value out of range: target.dot_count");
  }
}

TEST(ParameterRanges, PolarityIsZeroOrOne) {
  std::vector<std::uint8_t> block = default_block();
  write_word(block, 80, 2);
  seal(block);
  EXPECT_EQ(decoded_text(block), "value out of range: target.white_on_black");
}

TEST(ParameterRanges, TrackingIsZeroOrOne) {
  std::vector<std::uint8_t> block = default_block();
  write_word(block, block.size() - 8, 2);  // the last section's only field, before the CRC
  seal(block);
  EXPECT_EQ(decoded_text(block), "value out of range: mode.track");
}

TEST(ParameterRanges, AnyBitPatternInAnyFieldIsLegalInput) {
  const std::vector<std::uint8_t> block = default_block();
  for (std::size_t at = 20; at + 4 < block.size(); at += 4) {
    for (const std::uint32_t word : {0u, 1u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu, 0x40000000u}) {
      std::vector<std::uint8_t> changed = block;
      write_word(changed, at, word);
      seal(changed);
      Parameters out;
      if (decode_parameter_block(changed, out).is_ok()) {
        ASSERT_EQ(encoded(out), changed);
      }
    }
  }
}

}  // namespace
}  // namespace berth::test
