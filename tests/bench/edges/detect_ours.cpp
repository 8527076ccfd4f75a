#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bench/edges/detectors.hpp"
#include "common/view_of.hpp"
#include "edge/detect.hpp"
#include "edge/link.hpp"
#include "image/noise.hpp"
#include "pipeline/parameters.hpp"

namespace berth::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Storage of one thread: the flight pools where the image is binned, else four times as much.
struct Storage {
  explicit Storage(int bin)
      : pixels(bin == 1 ? 65535 : 16384),
        blocks(kMaxGridSide * kBlocksPerRow + 1),
        order(pixels.size()),
        row_of(pixels.size()),
        marks(pixels.size() / 32 + 1),
        chains(bin == 1 ? 8192 : 2048) {
    map.pixels = pixels;
    map.block_start = blocks;
    set.order = order;
    set.row_of = row_of;
    set.visited = marks;
    set.chains = chains;
  }

  std::vector<EdgePixel> pixels;
  std::vector<std::uint16_t> blocks, order, row_of;
  std::vector<std::uint32_t> marks;
  std::vector<Chain> chains;
  GradientRows rows;
  EdgeMap map;
  ChainSet set;
};

PixelChain read_chain(const Storage& s, const Chain& chain, int bin) {
  PixelChain out;
  for (int k = 0; k < chain.count; ++k) {
    const std::size_t i = s.set.order[static_cast<std::size_t>(chain.start + k)];
    const EdgePixel& p = s.map[static_cast<int>(i)];
    const cv::Point pixel(p.x(), s.set.row_of[i]);
    const double offset_px = bin * p.offset() / 64.0;
    out.pixels.push_back(pixel);
    out.places_px.push_back(centre_of(pixel, bin) + (p.is_steep_in_x()
                                                         ? cv::Point2d(offset_px, 0)
                                                         : cv::Point2d(0, offset_px)));
  }
  return out;
}

// What is left of the noise in a gradient component behind [1 2 1] / 4 both ways: norms of
// [1 6 15 20 15 6 1] / 64 and [-1 -4 -5 0 5 4 1] / 32 over those of our own kernels.
double share_of_noise() {
  return std::sqrt(924.0) / 64 * std::sqrt(84.0) / 32 /
         (std::sqrt(70.0) / 16 * std::sqrt(10.0) / 8);
}

DetectOutcome detect_pixels(const cv::Mat& image, const SearchGrid& grid, Storage& s, Work& work) {
  double noise_q8 = measure_noise_q8(view_of(image));
  cv::Mat frame;
  if (grid.bin == 1) {
    static const cv::Mat kernel = (cv::Mat_<float>(1, 3) << 0.25f, 0.5f, 0.25f);
    cv::sepFilter2D(image, frame, CV_8U, kernel, kernel);
    noise_q8 *= share_of_noise();
  } else {
    frame = image;
  }
  const int threshold = edge_threshold(static_cast<std::uint16_t>(std::lround(noise_q8)),
                                       Thresholds{}.edge_sigmas, grid.bin);
  return detect_edges(view_of(frame), grid, threshold, s.rows, s.map, work);
}

Detection detect(const cv::Mat& image, int bin, Storage& s) {
  const SearchGrid grid{0, 0, bin, image.cols / bin, image.rows / bin};
  Work work;  // without a limit, of this frame
  const auto start = Clock::now();
  const DetectOutcome outcome = detect_pixels(image, grid, s, work);
  link_edges(s.map, outcome.threshold * 3 / 2, s.set, work);
  const std::chrono::duration<double, std::milli> time = Clock::now() - start;
  Detection detection;
  detection.grid = {grid.width, grid.height};
  detection.bin = bin;
  detection.steps = s.set.steps;
  detection.time_ms = time.count();
  for (int c = 0; c < s.set.count; ++c) {
    detection.chains.push_back(read_chain(s, s.set.chains[static_cast<std::size_t>(c)], bin));
  }
  return detection;
}

}  // namespace

Detector make_ours(int bin) {
  const auto storage = std::make_shared<Storage>(bin);
  return {bin == 1   ? "Berthmark"
          : bin == 2 ? "Berthmark, binned 2 x 2 (second look)"
                     : "Berthmark, binned 4 x 4 (first look)",
          [=](const cv::Mat& image) { return detect(image, bin, *storage); }};
}

}  // namespace berth::bench
