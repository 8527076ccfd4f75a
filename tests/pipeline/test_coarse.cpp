// The first look at a quarter of the resolution: what it finds, and what it leaves to the finer
// one.
#include <gtest/gtest.h>

#include "chain_tools.hpp"
#include "pipeline/search.hpp"

namespace berth::test {
namespace {

FrameResult look_at(const host::Scene& scene) {
  return process(host::render_frame(scene, host::default_camera(), host::default_target()));
}

host::Scene scene_at(double distance_mm, double tilt_deg) {
  return host::clean_scene(pose_at(distance_mm, tilt_deg, 35));
}

/// A black patch over a part of the plate, millimetres.
host::Scene hide(host::Scene scene, double x, double y, double half_side) {
  scene.occluders.push_back({"patch",
                             -0.1,
                             {{x - half_side, y - half_side},
                              {x + half_side, y - half_side},
                              {x + half_side, y + half_side},
                              {x - half_side, y + half_side}},
                             scene.light.black_dn});
  return scene;
}

struct GridSearch {
  std::int32_t units = 0;  // of work
  double nearest_mm = 0;   // the distance of the ring that is nearest to the truth
};

/// Stages 1 and 2 of the whole frame, binned 2 x 2 or `coarse`.
GridSearch search_grid(const host::Image8& image, bool coarse, double truth_mm) {
  static const auto work = std::make_unique<Workspace>();
  const Parameters p =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  const ImageView view = view_of(image);
  FrameResult result;
  Work budget;
  work->ring_count = 0;
  const SearchGrid whole = whole_frame(view);
  search_edges(p, view, coarse ? coarser(whole) : whole, *work, result, budget);
  link_chains(*work, result, budget);
  cut_arcs(*work, result, budget);
  rings_from_arcs(0, work->arc_count, *work, result, budget);
  GridSearch search;
  search.units = static_cast<std::int32_t>(budget.units());
  for (int r = 0; r < work->ring_count; ++r) {
    PlatePose plates[2];
    if (!solve_plates(p.camera, p.target, work->grid, work->rings[r], plates, budget)) continue;
    const double z = std::ldexp(plates[0].center_mm[2].raw(), -18);
    if (std::abs(z - truth_mm) < std::abs(search.nearest_mm - truth_mm)) search.nearest_mm = z;
  }
  return search;
}

// What is seen, and what the search for it has cost: all before the last refinement.
struct Search {
  FrameResult result;
  std::int32_t units = 0, units_now = 0;
};

void find(const host::Scene& scene, Search& search) {
  const auto on_stage_end = [](void* context, Stage stage) {
    auto& s = *static_cast<Search*>(context);
    if (stage == Stage::kRefine) s.units = s.units_now;
    s.units_now = s.result.work_units;
  };
  const Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  const host::Image8 image =
      host::render_frame(scene, host::default_camera(), host::default_target());
  const auto workspace = std::make_unique<Workspace>();
  process_frame(parameters, view_of(image), {}, *workspace, search.result, {on_stage_end, &search});
}

// The whole search, markers and dots' pose and all, costs less than stages 1 and 2 alone would with
// cells half as wide; and a hidden dot, which is a doubt, makes it dearer.
TEST(CoarseLook, ATargetInPlainSightIsFoundForAFractionOfTheWork) {
  for (const double distance_mm : {300., 500., 800., 1200.}) {
    for (const double tilt_deg : {0., 20., 38.}) {
      SCOPED_TRACE(std::to_string(distance_mm) + " mm, " + std::to_string(tilt_deg) + " deg");
      const host::Scene scene = scene_at(distance_mm, tilt_deg);
      ASSERT_TRUE(look_at(scene).valid);
      Search whole, partly;
      find(scene, whole);
      find(hide(scene, 45, 45, 9), partly);
      EXPECT_EQ(whole.result.tally.dots_located, 5);
      EXPECT_LT(whole.units + 500, partly.units);
      const host::Image8 image =
          host::render_frame(scene, host::default_camera(), host::default_target());
      const std::int32_t coarse = search_grid(image, true, distance_mm).units;
      const std::int32_t fine = search_grid(image, false, distance_mm).units;
      EXPECT_LT(2 * coarse, fine);
      EXPECT_LT(whole.units, fine);
    }
  }
}

TEST(CoarseLook, WhereADotIsNotSeenTheFinerLookDecides) {
  for (const double distance_mm : {330., 700., 1200.}) {
    for (const double x : {-45., 45.}) {
      SCOPED_TRACE(std::to_string(distance_mm) + " mm");
      const host::Scene scene = hide(scene_at(distance_mm, 15), x, -45, 9);
      const FrameResult result = look_at(scene);
      ASSERT_TRUE(result.valid) << reason_name(result.reason);
      EXPECT_EQ(result.tally.dots_located, 4);
      const PoseErrors e = errors_of(result.pose.camera_from_target, scene.pose);
      EXPECT_LT(e.rotation_deg, 0.2);
      EXPECT_LT(e.translation_mm, 0.004 * distance_mm);
    }
  }
}

// Dots and line in place about a ring that the coarse grid shows well, but one dot missing more
// than may be hidden: neither look takes it.
TEST(CoarseLook, TwoLooksAreNoSecondChance) {
  for (const double distance_mm : {330., 700., 1200.}) {
    const FrameResult result =
        look_at(hide(hide(scene_at(distance_mm, 15), 45, -45, 9), -45, 45, 9));
    EXPECT_FALSE(result.identified);
    EXPECT_FALSE(result.has_pose);
    EXPECT_EQ(result.reason, Reason::kDotMissing) << reason_name(result.reason);
  }
}

// A dot is hidden, so that the coarse look doubts; the budget ends before the finer one does.
TEST(CoarseLook, ADoubtThatNothingFollowsLeavesNothingBehind) {
  const host::Image8 image = host::render_frame(hide(scene_at(700, 15), 45, -45, 9),
                                                host::default_camera(), host::default_target());
  Parameters parameters =
      host::make_parameters(host::default_camera(), host::default_target()).value();
  int spent = 0, found = 0;
  for (int budget = 3000; budget < 12000; budget += 100) {
    parameters.thresholds.search_budget_units = budget;
    const FrameResult result = process(image, parameters);
    found += result.valid ? 1 : 0;
    if (result.reason != Reason::kDeadline) continue;
    ++spent;
    EXPECT_FALSE(result.identified || result.valid || result.has_pose) << budget;
    EXPECT_EQ(result.markers.count, 0) << budget;
    EXPECT_EQ(result.tally.dots_located, 0) << budget;
    EXPECT_EQ(result.tally.identified_rank, 0) << budget;
    EXPECT_EQ(result.ring_radius_px, Px(0)) << budget;
  }
  EXPECT_GE(spent, 5);
  EXPECT_GE(found, 5);
}

// A band of one to three cells is seen up to 8 % too large by its outer edge.
TEST(CoarseLook, RingsOfAFewCellsAreAtTheirTrueDistance) {
  for (const double distance_mm : {500., 700., 900., 1100., 1300., 1450.}) {
    for (const double tilt_deg : {0., 20., 35.}) {
      const host::Scene scene = scene_at(distance_mm, tilt_deg);
      const host::Image8 image =
          host::render_frame(scene, host::default_camera(), host::default_target());
      for (const bool coarse : {false, true}) {
        EXPECT_NEAR(search_grid(image, coarse, distance_mm).nearest_mm / distance_mm, 1, 0.02)
            << distance_mm << " mm, " << tilt_deg << " deg, coarse: " << coarse;
      }
    }
  }
}

}  // namespace
}  // namespace berth::test
