#include <chrono>
#include <memory>

#include "bench/circles/detectors.hpp"
#include "common/view_of.hpp"
#include "pipeline/search.hpp"

namespace berth::bench {
namespace {

using Clock = std::chrono::steady_clock;

// What stages 1 and 2 need of the workspace; the rest belongs to later stages.
std::size_t bytes_of(const Workspace& w) {
  return sizeof w.edge_pixels + sizeof w.block_start + sizeof w.chain_order + sizeof w.chain_rows +
         sizeof w.edge_marks + sizeof w.chains + std::max(sizeof w.rows, sizeof w.votes) +
         sizeof w.arcs + sizeof w.candidates + sizeof w.rings;
}

FoundCircle circle_of(const RingCandidate& ring, const SearchGrid& grid) {
  const auto cells = [](Px v) { return v.raw() / 65536.0; };
  FoundCircle found;
  found.center = {cells(grid.to_frame_x(ring.ellipse.cx)), cells(grid.to_frame_y(ring.ellipse.cy))};
  found.major = grid.bin * cells(ring.axes.major);
  found.minor = grid.bin * cells(ring.axes.minor);
  return found;
}

CircleDetection detect(const cv::Mat& image, bool with_votes, Workspace& work) {
  const ImageView view = view_of(image);
  FrameResult result{};
  const Parameters parameters{};
  const auto start = Clock::now();
  work.ring_count = 0;
  Work budget;  // without a limit
  search_edges(parameters, view, whole_frame(view), work, result, budget);
  link_chains(work, result, budget);
  cut_arcs(work, result, budget);
  rings_from_arcs(0, work.arc_count, work, result, budget);
  if (with_votes) rings_from_votes(work, result, budget);
  const std::chrono::duration<double, std::milli> time = Clock::now() - start;
  CircleDetection detection;
  detection.time_ms = time.count();
  detection.bytes = bytes_of(work);
  for (int r = 0; r < work.ring_count; ++r) {
    detection.circles.push_back(circle_of(work.rings[r], work.grid));
  }
  return detection;
}

}  // namespace

CircleDetector make_ours(bool with_votes) {
  const std::shared_ptr<Workspace> work = std::make_unique<Workspace>();
  return {with_votes ? "Berthmark, arcs and votes" : "Berthmark, arcs",
          [=](const cv::Mat& image) { return detect(image, with_votes, *work); }};
}

}  // namespace berth::bench
