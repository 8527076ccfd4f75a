// Edge maps of OpenCV drawings, with storage, for the tests of stages 1 and 2.
#pragma once

#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/view_of.hpp"
#include "edge/detect.hpp"
#include "edge/link.hpp"

namespace berth {

class EdgeScene {
 public:
  explicit EdgeScene(const cv::Mat& image, int threshold = 512, int capacity = 30000,
                     int chain_capacity = 4000)
      : EdgeScene(view_of(image), whole_frame(view_of(image)), threshold, capacity,
                  chain_capacity) {}

  EdgeScene(const ImageView& view, const SearchGrid& region, int threshold, int capacity,
            int chain_capacity = 4000)
      : grid(region),
        pixels(static_cast<std::size_t>(capacity)),
        blocks(1024 * kBlocksPerRow + 1),
        order(static_cast<std::size_t>(capacity)),
        row_of(static_cast<std::size_t>(capacity)),
        marks(static_cast<std::size_t>(capacity / 32 + 1)),
        chains(static_cast<std::size_t>(chain_capacity)) {
    map.pixels = pixels;
    map.block_start = blocks;
    auto rows = std::make_unique<GradientRows>();
    outcome = detect_edges(view, grid, threshold, *rows, map, work);
    set.order = order;
    set.row_of = row_of;
    set.visited = marks;
    set.chains = chains;
    link_edges(map, outcome.threshold, set, work);
  }

  SearchGrid grid;
  EdgeMap map;
  ChainSet set;
  DetectOutcome outcome;
  mutable Work work;  // without a limit

 private:
  std::vector<EdgePixel> pixels;
  std::vector<std::uint16_t> blocks, order, row_of;
  std::vector<std::uint32_t> marks;
  std::vector<Chain> chains;
};

/// A disc (or a hole) of exact area coverage (8 x 8 samples) on a uniform ground, slightly blurred.
inline cv::Mat disc_image(double x, double y, double radius, int inside, int outside,
                          int side = 400) {
  constexpr int kSamples = 8;
  cv::Mat exact(side, side, CV_32F, cv::Scalar(outside));
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      int covered = 0;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const double du = u + (s % kSamples + 0.5) / kSamples - 0.5 - x;
        const double dv = v + (s / kSamples + 0.5) / kSamples - 0.5 - y;
        covered += du * du + dv * dv < radius * radius;
      }
      exact.at<float>(v, u) +=
          static_cast<float>((inside - outside) * covered) / (kSamples * kSamples);
    }
  }
  cv::GaussianBlur(exact, exact, {0, 0}, 0.8);
  cv::Mat image;
  exact.convertTo(image, CV_8U);
  return image;
}

}  // namespace berth
