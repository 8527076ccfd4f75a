#include "frame_set.hpp"

#include <random>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/target_file.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

constexpr int kSide = 1024;

// A frame from a function of x and y.
template <typename Level>
NamedFrame painted(const std::string& name, Level level) {
  NamedFrame frame{name, kSide, kSide, std::vector<std::uint8_t>(kSide * kSide)};
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      frame.pixels[static_cast<std::size_t>(y * kSide + x)] =
          static_cast<std::uint8_t>(level(x, y));
    }
  }
  return frame;
}

void add_renders(const std::string& name, const SceneOptions& options, std::uint64_t count,
                 std::vector<NamedFrame>& frames) {
  const Camera camera = default_camera();
  const Target target = default_target();
  for (std::uint64_t index = 0; index < count; ++index) {
    Image8 image = render_frame(sample_scene(options, index, camera, target), camera, target);
    frames.push_back(
        {name + " " + std::to_string(index), image.width, image.height, std::move(image.data)});
  }
}

void add_adversarial(std::vector<NamedFrame>& frames) {
  std::mt19937 random(11);
  const auto noise = [&](unsigned range) {
    return [&random, range](int, int) { return random() % range; };
  };
  frames.push_back(painted("noise", noise(256)));
  frames.push_back(painted("faint noise", noise(12)));
  frames.push_back(painted("black", [](int, int) { return 0; }));
  frames.push_back(painted("white", [](int, int) { return 255; }));
  frames.push_back(painted("half saturated", [](int x, int) { return x < kSide / 2 ? 255 : 0; }));
  for (const int pitch : {1, 2, 5, 16}) {
    frames.push_back(painted("checkerboard " + std::to_string(pitch),
                             [pitch](int x, int y) { return (x / pitch + y / pitch) % 2 * 255; }));
  }
  frames.push_back(painted("concentric rings", [](int x, int y) {
    const int r2 = (x - 512) * (x - 512) + (y - 512) * (y - 512);
    return r2 / 4096 % 2 * 200 + 20;
  }));
}

void add_unreadable(std::vector<NamedFrame>& frames) {
  frames.push_back({"unreadable", kSide, kSide, {}});
  frames.push_back({"small", 640, 480, std::vector<std::uint8_t>(640 * 480, 9)});
  frames.push_back({"large", 1600, 1200, std::vector<std::uint8_t>(1600 * 1200, 9)});
  frames.push_back({"cut short", kSide, kSide, std::vector<std::uint8_t>(1000, 9)});
}

}  // namespace

std::vector<NamedFrame> make_frame_set() {
  std::vector<NamedFrame> frames;
  SceneOptions options;
  options.seed = 7;
  add_renders("envelope", options, 48, frames);
  options.with_target = false;
  add_renders("no target", options, 8, frames);
  options.with_target = options.clean = true;
  options.distance_mm = 300;
  add_renders("clean at 300 mm", options, 6, frames);
  add_adversarial(frames);
  add_unreadable(frames);
  return frames;
}

}  // namespace berth::host
