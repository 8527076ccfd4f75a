#include <chrono>

#include "bench/edges/detectors.hpp"
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
      : pixels(bin == 2 ? 16384 : 65535),
        blocks(kMaxGridSide * kBlocksPerRow + 1),
        order(pixels.size()),
        row_of(pixels.size()),
        marks(pixels.size() / 32 + 1),
        chains(bin == 2 ? 2048 : 8192) {
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

Detection detect(const cv::Mat& image, int bin, Storage& s) {
  ImageView view;
  view.pixels = image.data;
  view.width = image.cols;
  view.height = image.rows;
  view.stride = static_cast<int>(image.step);
  const SearchGrid grid{0, 0, bin, image.cols / bin, image.rows / bin};
  const auto start = Clock::now();
  const int threshold = edge_threshold(measure_noise_q8(view), Thresholds{}.edge_sigmas, bin);
  const DetectOutcome outcome = detect_edges(view, grid, threshold, s.rows, s.map);
  link_edges(s.map, outcome.threshold * 3 / 2, s.set);
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
  return {bin == 1 ? "Berthmark" : "Berthmark, binned 2 x 2 (flight)",
          [=](const cv::Mat& image) { return detect(image, bin, *storage); }};
}

}  // namespace berth::bench
