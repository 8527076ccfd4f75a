// libFuzzer on the whole chain: no crash, no broken range, no outcome that contradicts itself.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "picture.hpp"
#include "pipeline/pipeline.hpp"

namespace {

using namespace berth;

void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "contradiction: %s\n", what);
  std::abort();
}

void check(const FrameResult& r) {
  demand(r.reason < Reason::kCount, "a reason without a name");
  demand(r.valid == (r.reason == Reason::kNone), "valid with a reason, or neither");
  demand(!r.valid || (r.identified && r.has_pose), "valid without target or pose");
  demand(!r.has_pose || r.identified, "a pose of nothing");
  demand(r.reason != Reason::kBadFrame, "the frame has the camera's size");
  demand(r.markers.count >= 0 && r.markers.count <= kMaxMarkers, "more markers than there are");
  if (!r.valid) return;
  for (int k = 0; k < 3; ++k) {
    demand(r.pose.covariance.sigma_rotation[k].raw() > 0, "rotation known without error");
    demand(r.pose.covariance.sigma_translation_mm[k].raw() > 0, "translation known without error");
  }
  demand(r.pose.camera_from_target.translation_mm[2].raw() > 0, "behind the camera");
  demand(r.pose.markers_used >= 1, "a pose from no marker");
}

FrameResult run(const fuzz::Picture& picture, const Prior& prior, Workspace& workspace) {
  ImageView view;
  view.pixels = picture.pixels.data();
  view.width = picture.width;
  view.height = picture.height;
  view.stride = picture.width;
  FrameResult result;
  process_frame(picture.parameters, view, prior, workspace, result);
  return result;
}

// A pose in sight, 250 to 1780 mm away, turned as the one that was found, if any.
Prior prior_from(const std::uint8_t* data, const FrameResult& found) {
  Prior prior;
  prior.has_pose = true;
  const std::int32_t z_mm = 250 + 6 * data[6];
  const auto across = [&](std::uint8_t byte) {
    return Mm::from_raw((byte - 128) * (z_mm << 18 >> 8));
  };
  prior.camera_from_target = found.pose.camera_from_target;
  prior.camera_from_target.translation_mm = {across(data[4]), across(data[5]), Mm(z_mm)};
  return prior;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto workspace = std::make_unique<Workspace>();
  fuzz::Picture picture = fuzz::decode_picture(data, size);
  const FrameResult once = run(picture, {}, *workspace);
  check(once);
  const int variation = size > 7 ? data[7] & 7 : 0;
  if (variation == 7) {  // a workspace soiled with anything gives the same bits
    std::memset(static_cast<void*>(workspace.get()), data[7], sizeof(Workspace));
    const FrameResult again = run(picture, {}, *workspace);
    demand(std::memcmp(once.digests, again.digests, sizeof once.digests) == 0, "other bits");
  } else if (variation == 6 && once.has_pose) {  // tracked from its own pose
    check(run(picture, {true, once.pose.camera_from_target, once.blur}, *workspace));
  } else if (variation == 4) {  // tracked from where the target was, which is anywhere in sight
    check(run(picture, prior_from(data, once), *workspace));
  } else if (variation == 5) {  // a deadline anywhere before that of the first run
    Thresholds& t = picture.parameters.thresholds;
    t.search_budget_units = t.search_budget_units / 256 * data[6];
    t.frame_budget_units = t.frame_budget_units / 256 * data[6];
    const FrameResult cut = run(picture, {}, *workspace);
    check(cut);
    demand(cut.work_units <= once.work_units, "more work on a smaller budget");
  }
  return 0;
}
