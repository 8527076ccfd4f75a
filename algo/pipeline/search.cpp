#include "pipeline/search.hpp"

#include "camera/projection.hpp"
#include "core/digest.hpp"
#include "fixed/trigonometry.hpp"
#include "image/noise.hpp"
#include "image/packed.hpp"

namespace berth {
namespace {

// Of 32 sectors of the outline: a quarter hidden, the collar and shadow edges still leave half.
constexpr int kMinCoveredSectors = 14;

constexpr std::uint32_t kStepsForNoise = 71000, kStepsPerDigest = 14;  // of a pixel
constexpr std::uint32_t kStepsPerPlaceOfArc = 50;

std::uint16_t clamp16(int value) {
  return static_cast<std::uint16_t>(value > 65535 ? 65535 : value);
}

// A stage may run more than once.
void add_digest(Stage stage, std::uint32_t value, FrameResult& result) {
  std::uint32_t& digest = result.digests[static_cast<int>(stage)];
  digest = digest * 31 + value;
}

std::uint32_t digest_of(const EdgeMap& map) {
  Digest digest;
  const EdgePixel* p = map.pixels.data();
  for (const EdgePixel* const end = p + map.count; p != end; ++p) {
    const Pair place_and_gx = load(p), gy_and_lvv = load(&p->gy);
    digest.add(first_and_second(place_and_gx, gy_and_lvv));
    digest.add(place_and_gx >> 16 | gy_and_lvv << 16);
  }
  return digest.value();
}

std::uint32_t digest_of(const ChainSet& set) {
  Digest digest;
  for (int c = 0; c < set.count; ++c) {
    const Chain& chain = set.chains[static_cast<std::size_t>(c)];
    digest.add(chain.count);
    const std::uint16_t* order = set.order.data() + chain.start;
    for (const std::uint16_t* const end = order + chain.count; order != end;) digest.add(*order++);
  }
  return digest.value();
}

void add_ring(const RingCandidate& ring, Digest& digest) {
  digest.add_signed(ring.ellipse.cx.raw());
  digest.add_signed(ring.ellipse.cy.raw());
  for (const auto& row : ring.ellipse.m) {
    for (const Q<26> v : row) digest.add_signed(v.raw());
  }
  digest.add_signed(ring.covered);
}

// Best-covered outlines first, of those from `first` on: they are looked at in this order.
void insert_by_cover(const RingCandidate& ring, int first, Workspace& work) {
  int at = work.ring_count++;
  for (; at > first && work.rings[at - 1].covered < ring.covered; --at) {
    work.rings[at] = work.rings[at - 1];
  }
  work.rings[at] = ring;
}

bool is_explained(const Workspace& work, const Arc& arc) {
  for (int r = 0; r < work.ring_count; ++r) {
    if (is_explained(work.map, work.set, arc, work.rings[r])) return true;
  }
  return false;
}

bool is_explained(const Workspace& work, const CircleCandidate& candidate) {
  for (int r = 0; r < work.ring_count; ++r) {
    if (is_explained(candidate, work.rings[r])) return true;
  }
  return false;
}

// Of two outlines of one ring the better covered one is kept: a shadow's edge or an occluder may
// have led the other astray.
void keep(const RingCandidate& ring, int first, Workspace& work) {
  for (int r = 0; r < work.ring_count; ++r) {
    if (!is_same_ring(work.rings[r], ring)) continue;
    if (work.rings[r].covered >= ring.covered) return;
    if (r < first) continue;  // it has been looked at
    for (int k = r; k + 1 < work.ring_count; ++k) work.rings[k] = work.rings[k + 1];
    --work.ring_count;
    --r;
  }
  if (work.ring_count < kMaxRings) insert_by_cover(ring, first, work);
}

void end_rings(int first, const Workspace& work, FrameResult& result) {
  Digest digest;
  for (int r = first; r < work.ring_count; ++r) add_ring(work.rings[r], digest);
  result.tally.ellipses = clamp16(work.ring_count);
  add_digest(Stage::kCircles, digest.value(), result);
}

std::uint32_t digest_of(const Identification& id) {
  Digest digest;
  digest.add(static_cast<std::uint32_t>(id.reason));
  digest.add_signed(id.line_stations);
  for (int k = 0; k < 3; ++k) digest.add_signed(id.camera_from_target.translation_mm[k].raw());
  for (int k = 0; k < 9; ++k) digest.add_signed(id.camera_from_target.rotation(k / 3, k % 3).raw());
  return digest.value();
}

}  // namespace

bool know_noise(const ImageView& image, FrameResult& result, Work& budget) {
  if (result.tally.noise_q8 != 0) return true;
  if (!budget.take(kStepsForNoise)) return false;
  result.tally.noise_q8 = measure_noise_q8(image);
  return true;
}

void search_edges(const Parameters& parameters, const ImageView& image, const SearchGrid& grid,
                  Workspace& work, FrameResult& result, Work& budget) {
  work.grid = grid;
  work.map.pixels = work.edge_pixels;
  work.map.block_start = work.block_start;
  work.map.count = 0;
  if (!know_noise(image, result, budget)) return;
  const int threshold =
      edge_threshold(result.tally.noise_q8, parameters.thresholds.edge_sigmas, work.grid.bin);
  const DetectOutcome outcome =
      detect_edges(image, work.grid, threshold, work.rows, work.map, budget);
  result.tally.edge_threshold = clamp16(outcome.threshold);
  result.tally.edge_pixels = clamp16(work.map.count);
  if (outcome.pool_full) result.tally.pools_full |= 1;
  budget.spend(static_cast<std::uint32_t>(work.map.count) * kStepsPerDigest);
  add_digest(Stage::kEdges, digest_of(work.map), result);
}

void link_chains(Workspace& work, FrameResult& result, Work& budget) {
  work.set.order = work.chain_order;
  work.set.row_of = work.chain_rows;
  work.set.visited = work.edge_marks;
  work.set.chains = work.chains;
  link_edges(work.map, result.tally.edge_threshold * 3 / 2, work.set, budget);
  result.tally.chains = clamp16(work.set.count);
  if (work.set.pool_full) result.tally.pools_full |= 2;
  add_digest(Stage::kLink, digest_of(work.set), result);
}

int cut_arcs(Workspace& work, FrameResult& result, Work& budget) {
  work.arc_count = find_arcs(work.map, work.set, work.arcs, budget);
  result.tally.circle_candidates = clamp16(work.arc_count);
  int whole = 0;
  while (whole < work.arc_count && work.arcs[whole].turn >= kWholeTurn) ++whole;
  return whole;
}

void rings_from_arcs(int begin, int end, Workspace& work, FrameResult& result, Work& budget) {
  const int first = work.ring_count;
  for (int a = begin; a < end && !budget.is_spent(); ++a) {
    RingCandidate ring;
    budget.spend(static_cast<std::uint32_t>(work.ring_count) * 5 * kStepsPerPlaceOfArc);
    if (is_explained(work, work.arcs[a])) continue;
    if (!fit_ring(work.map, work.set, work.arcs[a], kMinCoveredSectors, ring, budget)) {
      continue;
    }
    keep(ring, first, work);
  }
  end_rings(first, work, result);
}

void rings_from_votes(Workspace& work, FrameResult& result, Work& budget) {
  const int first = work.ring_count;
  cast_votes(work.map, work.set, work.votes, budget);
  work.candidate_count = find_candidates(work.votes, work.candidates, budget);
  result.tally.votes = clamp16(work.votes.votes);
  result.tally.circle_candidates = clamp16(work.arc_count + work.candidate_count);
  for (int c = 0; c < work.candidate_count && !budget.is_spent(); ++c) {
    RingCandidate ring;
    if (is_explained(work, work.candidates[c])) continue;
    if (!fit_ring(work.map, work.set, work.candidates[c], kMinCoveredSectors, ring, budget)) {
      continue;
    }
    keep(ring, first, work);
  }
  end_rings(first, work, result);
}

Identification identify_plate(const Parameters& parameters, const ImageView& image,
                              const PlatePose& plate, bool has_roll, FrameResult& result,
                              Work& budget) {
  const Identification id = identify_target(parameters.camera, image, plate, parameters.target,
                                            result.tally.noise_q8, budget, has_roll);
  add_digest(Stage::kIdentify, digest_of(id), result);
  return id;
}

void drop_unlikeliest_dot(const Parameters& parameters, const Identification& id,
                          FrameResult& result) {
  const RigidTransform& t = id.camera_from_target;
  MarkerSet& set = result.markers;
  std::int64_t dx[kMaxMarkers] = {}, dy[kMaxMarkers] = {};  // 16 fraction bits, below 2^28
  std::int64_t sum_x = 0, sum_y = 0;
  int count = 0;
  for (int m = 0; m < set.count; ++m) {
    const Marker& marker = set.markers[m];
    if (marker.kind != MarkerKind::kDot || !marker.located) continue;
    const Vec3Mm place = parameters.target.dots[marker.index].center_mm;
    const Vec2Px predicted =
        project(parameters.camera, Vec3Mm(t.rotation * place + t.translation_mm));
    dx[m] = std::int64_t{marker.center_px[0].raw()} - predicted[0].raw();
    dy[m] = std::int64_t{marker.center_px[1].raw()} - predicted[1].raw();
    sum_x += dx[m];
    sum_y += dy[m];
    ++count;
  }
  int worst = 0;
  std::int64_t most = -1;
  for (int m = 0; m < set.count; ++m) {
    const Marker& marker = set.markers[m];
    if (marker.kind != MarkerKind::kDot || !marker.located) continue;
    const std::int64_t x = dx[m] - sum_x / count, y = dy[m] - sum_y / count;
    if (x * x + y * y <= most) continue;
    most = x * x + y * y;
    worst = m;
  }
  set.markers[worst].located = false;
  result.tally.dots_located = static_cast<std::uint16_t>(count - 1);
}

}  // namespace berth
