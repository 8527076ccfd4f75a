// Renders a scene: the yardstick for everything that measures images.
//
//   radiance = background, plate, markers with exact area coverage, times light, plus glints
//   noise-free = 255 (((PSF * radiance) vignette + stray) / 255)^gamma
//   frame = clip(round(noise-free + noise))
//
// The same scene gives the same bytes on every machine. A frame of 1024 x 1024 takes some tens of
// milliseconds on one core; functions may be called from several threads at once.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/scene.hpp"

namespace berth::host {

/// An 8-bit monochrome image, row by row.
struct Image8 {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> data;
};

/// The image before noise, rounding and clipping, in DN; resized to width * height of the camera.
void render(const Scene& scene, const Camera& camera, const Target& target,
            std::vector<float>& noise_free);

/// Adds Gaussian noise of `sigma_dn`, rounds to the nearest whole DN and clips to 0 ... 255. Other
/// noise seeds give independent draws over the same scene.
Image8 quantise(const std::vector<float>& noise_free, int width, int height, double sigma_dn,
                uint64_t noise_seed);

/// The final frame.
Image8 render_frame(const Scene& scene, const Camera& camera, const Target& target);

}  // namespace berth::host
