#include "host_sim/budget/hard_frames.hpp"

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "host_sim/campaign/frame_maker.hpp"
#include "host_sim/render/render.hpp"
#include "host_sim/render/sample_scene.hpp"

namespace berth::host {
namespace {

constexpr uint64_t kSeed = 1;
constexpr double kTwoPi = 6.283185307179586;

cv::Mat to_mat(const Image8& image) {
  return cv::Mat(image.height, image.width, CV_8UC1, const_cast<uint8_t*>(image.data.data()))
      .clone();
}

/// grey(x, y) at every pixel, rounded and clipped.
cv::Mat draw(cv::Size size, const std::function<double(int, int)>& grey) {
  cv::Mat image(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(grey(x, y));
    }
  }
  return image;
}

cv::Mat noise(cv::Size size, double sigma) {
  cv::RNG random(kSeed);
  cv::Mat image(size, CV_8UC1);
  random.fill(image, cv::RNG::NORMAL, 128, sigma);
  return image;
}

cv::Mat checkerboard(cv::Size size, int pitch) {
  return draw(size, [pitch](int x, int y) { return (x / pitch + y / pitch) % 2 ? 230 : 20; });
}

cv::Mat mosaic(cv::Size size, int pitch) {
  cv::RNG random(kSeed);
  cv::Mat small(size / pitch, CV_8UC1), image;
  random.fill(small, cv::RNG::UNIFORM, 0, 256);
  cv::resize(small, image, size, 0, 0, cv::INTER_NEAREST);
  return image;
}

cv::Mat grating(cv::Size size, double pitch) {
  return draw(size, [pitch](int x, int y) {
    return 127.5 + 110 * std::sin(kTwoPi * (x * 0.8 + y * 0.6) / pitch);
  });
}

cv::Mat concentric_rings(cv::Size size, double pitch) {
  return draw(size, [pitch, size](int x, int y) {
    const double radius = std::hypot(x - size.width / 2 + 0.5, y - size.height / 2 + 0.5);
    return 127.5 + 110 * std::sin(kTwoPi * radius / pitch);
  });
}

cv::Mat ring_lattice(cv::Size size, int pitch) {
  return draw(size, [pitch](int x, int y) {
    const double radius =
        std::hypot(x % pitch - pitch / 2 + 0.5, y % pitch - pitch / 2 + 0.5) / pitch;
    return radius > 0.30 && radius < 0.44 ? 210 : 30;
  });
}

cv::Mat ring_clutter(cv::Size size) {
  cv::RNG random(kSeed);
  cv::Mat image(size, CV_8UC1, cv::Scalar(30));
  for (int i = 0; i < 400; ++i) {
    const cv::Point center(random.uniform(0, size.width), random.uniform(0, size.height));
    const int radius = static_cast<int>(std::pow(10, random.uniform(0.8, 2.0)));
    cv::circle(image, center, radius, random.uniform(60, 255), std::max(1, radius / 5),
               cv::LINE_AA);
  }
  return image;
}

// A hundred targets, each with a line that is a fifth too long, seen from 1500 mm.
cv::Mat near_misses(const Camera& camera, const Target& target) {
  const Target longer = near_miss_target(NearMissKind::kLineLength, target, 0.2);
  const Pose pose{Eigen::Matrix3d::Identity(), {0, 0, 1500}};
  const cv::Mat view = to_mat(render_frame(clean_scene(pose), camera, longer));
  const int side = view.cols / 10;
  const cv::Mat tile = view(cv::Rect((view.cols - side) / 2, (view.rows - side) / 2, side, side));
  cv::Mat image;
  cv::repeat(tile, view.rows / side + 1, view.cols / side + 1, image);
  return image(cv::Rect(0, 0, view.cols, view.rows)).clone();
}

cv::Mat half_of(const cv::Mat& upper, const cv::Mat& lower) {
  cv::Mat image = lower.clone();
  upper.rowRange(0, upper.rows / 2).copyTo(image.rowRange(0, image.rows / 2));
  return image;
}

}  // namespace

std::vector<NamedFrame> envelope_frames(int count, const Camera& camera, const Target& target) {
  const FrameMaker maker(CampaignSet::kEnvelope, kSeed, camera, target, std::nullopt);
  std::vector<NamedFrame> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(
        {"envelope " + std::to_string(i), to_mat(maker.make(static_cast<uint64_t>(i)).image)});
  }
  return frames;
}

std::vector<NamedFrame> frames_at(double distance_mm, int count, const Camera& camera,
                                  const Target& target) {
  SceneOptions options;
  options.seed = kSeed;
  options.distance_mm = distance_mm;
  options.share_occluded = 0;  // what is searched is counted, not what is found
  std::vector<NamedFrame> frames;
  for (uint64_t i = 0; frames.size() < static_cast<std::size_t>(count); ++i) {
    const Scene scene = sample_scene(options, i, camera, target);
    if (!scene.is_plate_inside) continue;
    frames.push_back({std::to_string(static_cast<int>(distance_mm)) + " mm",
                      to_mat(render_frame(scene, camera, target))});
  }
  return frames;
}

std::vector<NamedFrame> adversarial_frames(const Camera& camera, const Target& target) {
  const cv::Size size(camera.width, camera.height);
  const cv::Mat plain = envelope_frames(1, camera, target).front().image;
  const auto pitched = [](const char* what, int pitch) {
    return std::string(what) + " of " + std::to_string(pitch) + " px";
  };
  std::vector<NamedFrame> frames;
  for (const int sigma : {5, 20, 60}) {
    frames.push_back({"noise of " + std::to_string(sigma) + " DN", noise(size, sigma)});
  }
  for (const int pitch : {2, 3, 4, 5, 8, 16, 32}) {
    frames.push_back({pitched("checkerboard", pitch), checkerboard(size, pitch)});
  }
  for (const int pitch : {2, 8}) frames.push_back({pitched("mosaic", pitch), mosaic(size, pitch)});
  for (const int pitch : {4, 6, 8, 16}) {
    frames.push_back({pitched("grating", pitch), grating(size, pitch)});
  }
  for (const int pitch : {8, 16, 32}) {
    frames.push_back({pitched("concentric rings", pitch), concentric_rings(size, pitch)});
  }
  for (const int pitch : {16, 32, 64, 128}) {
    frames.push_back({pitched("lattice of rings", pitch), ring_lattice(size, pitch)});
  }
  frames.push_back({"400 rings", ring_clutter(size)});
  frames.push_back({"100 near misses", near_misses(camera, target)});
  frames.push_back({"black", cv::Mat(size, CV_8UC1, cv::Scalar(0))});
  frames.push_back({"white", cv::Mat(size, CV_8UC1, cv::Scalar(255))});
  frames.push_back({"half a checkerboard of 8 px", half_of(checkerboard(size, 8), plain)});
  frames.push_back({"half a lattice of 32 px", half_of(ring_lattice(size, 32), plain)});
  frames.push_back({"half noise of 60 DN", half_of(noise(size, 60), plain)});
  return frames;
}

}  // namespace berth::host
