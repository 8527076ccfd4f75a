#include "host_sim/replay/setup.hpp"

#include "host_sim/parameters/build_block.hpp"
#include "host_sim/replay/image_input.hpp"

namespace berth::host {

tl::expected<Setup, std::string> load_setup(const ReplayOptions& options) {
  using CameraResult = tl::expected<Camera, std::string>;
  using TargetResult = tl::expected<Target, std::string>;
  using MountResult = tl::expected<Mount, std::string>;
  const CameraResult camera =
      options.camera.empty() ? CameraResult(default_camera()) : load_camera(options.camera);
  if (!camera) return tl::unexpected(camera.error());
  const TargetResult target =
      options.target.empty() ? TargetResult(default_target()) : load_target(options.target);
  if (!target) return tl::unexpected(target.error());
  const MountResult mount =
      options.mount.empty() ? MountResult(Mount{}) : load_mount(options.mount);
  if (!mount) return tl::unexpected(mount.error());

  Setup setup;
  setup.full_camera = *camera;
  setup.binning = binning_for(camera->width, camera->height);
  setup.camera = setup.binning == 1 ? *camera : binned(*camera, setup.binning);
  setup.target = *target;
  setup.mount = *mount;
  auto block = build_parameter_block(setup.camera, setup.target, setup.mount, {options.track});
  if (!block) return tl::unexpected(block.error());
  setup.parameter_block = std::move(*block);
  return setup;
}

}  // namespace berth::host
