#include "host_sim/render/render.hpp"

#include "host_sim/render/base_layer.hpp"
#include "host_sim/render/marker_layer.hpp"
#include "host_sim/render/sensor.hpp"

namespace berth::host {
namespace {

struct Workspace {
  BaseScratch base;
  MarkerScratch markers;
  Plane image;
};

}  // namespace

void render(const Scene& scene, const Camera& camera, const Target& target,
            std::vector<float>& noise_free) {
  // Megabytes that would be mapped anew for each frame of a campaign.
  thread_local Workspace workspace;
  const LightField light(scene, camera, target, margin_of(scene.optics));
  render_base(scene, camera, target, light, workspace.base, workspace.image);
  if (scene.has_target) {
    add_markers(scene, camera, target, light, workspace.markers, workspace.image);
  }
  respond(scene, workspace.image);
  noise_free.assign(workspace.image.data.begin(), workspace.image.data.end());
}

Image8 render_frame(const Scene& scene, const Camera& camera, const Target& target) {
  std::vector<float> noise_free;
  render(scene, camera, target, noise_free);
  return quantise(noise_free, camera.width, camera.height, scene.noise_dn, scene.noise_seed);
}

}  // namespace berth::host
