#include "bench/edges/truth.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <unordered_map>
#include <utility>

#include "host_sim/render/outline.hpp"

namespace berth::bench {
namespace {

constexpr double kSpacing_px = 0.25;
constexpr double kHiddenMargin_px = 3.0;
constexpr int kLeastPixels = 4;  // of a chain on a contour, to count as one of its pieces

std::vector<cv::Point2d> resample(const host::Polygon& polygon) {
  std::vector<cv::Point2d> points;
  double next = 0;  // distance along the outline at which the next point stands
  double travelled = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double length = (b - a).norm();
    for (; next < travelled + length; next += kSpacing_px) {
      const Eigen::Vector2d p = a + (next - travelled) / length * (b - a);
      points.emplace_back(p.x(), p.y());
    }
    travelled += length;
  }
  return points;
}

using Cover = std::vector<cv::Point2f>;

Cover to_cover(const host::Polygon& polygon) {
  Cover cover;
  for (const auto& p : polygon) {
    cover.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return cover;
}

// What hides parts of the plate (and, of these, what stands in front of raised dots).
struct Covers {
  std::vector<Cover> over_plate, over_all;
};

Covers covers_of(const host::Scene& scene, const host::View& view, const host::Target& target) {
  Covers covers;
  for (const host::Occluder& o : scene.occluders) {
    covers.over_all.push_back(to_cover(project_polygon(view, o.outline_mm, o.z_mm)));
  }
  covers.over_plate = covers.over_all;
  for (const host::Dot& dot : target.dots) {
    if (dot.center[2] == 0.0) continue;
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    const double radius = std::max(dot.radius, dot.collar_radius);
    covers.over_plate.push_back(to_cover(project_circle(view, center, radius)));
    if (dot.post_radius > 0) covers.over_plate.push_back(to_cover(project_post(view, dot)));
  }
  return covers;
}

TrueContour make_contour(const host::Polygon& outline, const std::vector<Cover>& covers) {
  TrueContour contour;
  contour.points_px = resample(outline);
  for (const cv::Point2d& p : contour.points_px) {
    const cv::Point2f q(p);
    contour.is_visible.push_back(std::none_of(covers.begin(), covers.end(), [&](const Cover& c) {
      return cv::pointPolygonTest(c, q, true) > -kHiddenMargin_px;
    }));
  }
  return contour;
}

// The nearest point of all contours, by buckets of 4 px.
class NearestPoint {
 public:
  struct Hit {
    int contour = -1, point = -1;
    double distance = kReach_px;
  };

  explicit NearestPoint(const std::vector<TrueContour>& contours) : contours_(contours) {
    for (size_t c = 0; c < contours.size(); ++c) {
      for (size_t k = 0; k < contours[c].points_px.size(); ++k) {
        buckets_[key(contours[c].points_px[k], 0, 0)].push_back(
            {static_cast<int>(c), static_cast<int>(k)});
      }
    }
  }

  Hit find(cv::Point2d p) const {
    Hit hit;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto bucket = buckets_.find(key(p, dx, dy));
        if (bucket == buckets_.end()) continue;
        for (const auto& [c, k] : bucket->second) {
          const auto& q = contours_[static_cast<size_t>(c)].points_px[static_cast<size_t>(k)];
          const double d = cv::norm(q - p);
          if (d < hit.distance) hit = {c, k, d};
        }
      }
    }
    if (hit.contour >= 0) hit.distance = distance_to_outline(p, hit);
    return hit;
  }

 private:
  // To the two segments that meet at the nearest point.
  double distance_to_outline(cv::Point2d p, const Hit& hit) const {
    const auto& points = contours_[static_cast<size_t>(hit.contour)].points_px;
    const size_t k = static_cast<size_t>(hit.point), count = points.size();
    const cv::Point2d at = points[k];
    double least = hit.distance;
    for (const cv::Point2d& end : {points[(k + 1) % count], points[(k + count - 1) % count]}) {
      const cv::Point2d along = end - at;
      const double s = (p - at).dot(along) / std::max(along.dot(along), 1e-12);
      if (s > 0 && s < 1) least = std::min(least, cv::norm(p - at - s * along));
    }
    return least;
  }

  static long key(cv::Point2d p, int dx, int dy) {
    const long x = std::lround(std::floor(p.x / 4)) + dx, y = std::lround(std::floor(p.y / 4)) + dy;
    return y * 100000 + x;
  }
  const std::vector<TrueContour>& contours_;
  std::unordered_map<long, std::vector<std::pair<int, int>>> buckets_;
};

struct Coverage {
  std::vector<std::vector<char>> is_found;       // per contour and point
  std::vector<std::map<size_t, int>> pixels_of;  // per contour: pixels of each chain
};

// A pixel stands for the outline up to half a diagonal step to both sides, and a step of the chain
// for what lies between its ends.
void cover(const NearestPoint::Hit& hit, const NearestPoint::Hit& before, int bin,
           Coverage& coverage) {
  auto& found = coverage.is_found[static_cast<size_t>(hit.contour)];
  const int count = static_cast<int>(found.size());
  const int reach = static_cast<int>(0.75 * bin / kSpacing_px), step = 4 * reach;
  int first = hit.point - reach, last = hit.point + reach;
  if (before.contour == hit.contour) {
    const int turn = ((before.point - hit.point) % count + count + count / 2) % count - count / 2;
    if (turn < 0 && turn >= -step) first = std::min(first, hit.point + turn);
    if (turn > 0 && turn <= step) last = std::max(last, hit.point + turn);
  }
  for (int k = first; k <= last; ++k) found[static_cast<size_t>((k + count) % count)] = 1;
}

// Turning along runs of pixels that lie on the true outline.
void add_turning(const PixelChain& chain, const std::vector<char>& is_on, TruthTally& tally) {
  PixelChain run;
  for (size_t i = 0; i <= chain.pixels.size(); ++i) {
    if (i < chain.pixels.size() && is_on[i]) {
      run.pixels.push_back(chain.pixels[i]);
      run.places_px.push_back(chain.places_px[i]);
      continue;
    }
    tally.turning.merge(turning_deg(run.pixels));
    tally.turning_of_places.merge(turning_deg(run.places_px));
    run = {};
  }
}

// Where the outline crosses the rows (where it is steep) or columns of pixels, in order.
PixelChain round_outline(const std::vector<cv::Point2d>& points) {
  PixelChain chain;
  for (size_t k = 0; k < points.size(); ++k) {
    const cv::Point2d a = points[k], b = points[(k + 1) % points.size()];
    const bool is_steep = std::abs(b.x - a.x) < std::abs(b.y - a.y);
    const double from = is_steep ? a.y : a.x, to = is_steep ? b.y : b.x;
    const double line = std::max(std::floor(from), std::floor(to));
    if (std::floor(from) == std::floor(to)) continue;
    const cv::Point2d place = a + (line - from) / (to - from) * (b - a);
    const cv::Point pixel(cvRound(place.x), cvRound(place.y));
    if (!chain.pixels.empty() && chain.pixels.back() == pixel) continue;
    chain.pixels.push_back(pixel);
    chain.places_px.push_back(place);
  }
  return chain;
}

void compare_chain(const Detection& detection, size_t index, const NearestPoint& nearest,
                   const std::vector<TrueContour>& contours, Coverage& coverage,
                   TruthTally& tally) {
  const PixelChain& chain = detection.chains[index];
  std::vector<char> is_on(chain.pixels.size(), 0);
  NearestPoint::Hit before;
  for (size_t i = 0; i < chain.pixels.size(); ++i) {
    const NearestPoint::Hit hit = nearest.find(chain.places_px[i]);
    const NearestPoint::Hit last = std::exchange(before, hit);
    if (hit.contour < 0) continue;
    const size_t c = static_cast<size_t>(hit.contour);
    if (!contours[c].is_visible[static_cast<size_t>(hit.point)]) continue;
    is_on[i] = 1;
    tally.places.add(hit.distance);
    tally.pixels.add(nearest.find(centre_of(chain.pixels[i], detection.bin)).distance);
    ++coverage.pixels_of[c][index];
    cover(hit, last, detection.bin, coverage);
  }
  add_turning(chain, is_on, tally);
}

}  // namespace

int TrueContour::arcs() const {
  int begins = 0;
  for (size_t k = 0; k < is_visible.size(); ++k) {
    begins += is_visible[k] && !is_visible[k == 0 ? is_visible.size() - 1 : k - 1];
  }
  const bool is_whole = begins == 0 && !is_visible.empty() && is_visible[0];
  return is_whole ? 1 : begins;
}

std::vector<TrueContour> true_contours(const host::Scene& scene, const host::Camera& camera,
                                       const host::Target& target) {
  const host::View view{camera, scene.pose};
  const Covers covers = covers_of(scene, view, target);
  std::vector<TrueContour> contours;
  for (const double radius : {target.ring.outer, target.ring.inner}) {
    contours.push_back(
        make_contour(project_circle(view, Eigen::Vector3d::Zero(), radius), covers.over_plate));
  }
  contours.push_back(make_contour(project_line(view, target.line), covers.over_plate));
  for (const host::Dot& dot : target.dots) {
    const Eigen::Vector3d center(dot.center[0], dot.center[1], dot.center[2]);
    contours.push_back(make_contour(project_circle(view, center, dot.radius),
                                    dot.center[2] == 0 ? covers.over_plate : covers.over_all));
  }
  return contours;
}

void DistanceTally::add(double distance_px) {
  const int bin = std::min(static_cast<int>(distance_px * 100), static_cast<int>(bins.size()) - 1);
  ++bins[static_cast<size_t>(bin)];
  mean.add(distance_px);
}

void DistanceTally::merge(const DistanceTally& other) {
  for (size_t i = 0; i < bins.size(); ++i) bins[i] += other.bins[i];
  mean.merge(other.mean);
}

double DistanceTally::quantile(double share) const {
  double below = 0;
  for (size_t i = 0; i < bins.size(); ++i) {
    below += static_cast<double>(bins[i]);
    if (below >= share * mean.weight) return 0.01 * static_cast<double>(i + 1);
  }
  return 0;
}

void TruthTally::merge(const TruthTally& other) {
  found.merge(other.found);
  places.merge(other.places);
  pixels.merge(other.pixels);
  pieces.merge(other.pieces);
  turning.merge(other.turning);
  turning_of_places.merge(other.turning_of_places);
}

Detection round_outlines(const std::vector<TrueContour>& contours, cv::Size frame) {
  Detection detection;
  detection.grid = frame;
  for (const TrueContour& c : contours) detection.chains.push_back(round_outline(c.points_px));
  return detection;
}

TruthTally compare(const Detection& detection, const std::vector<TrueContour>& contours) {
  const NearestPoint nearest(contours);
  Coverage coverage;
  for (const TrueContour& c : contours) coverage.is_found.emplace_back(c.points_px.size(), 0);
  coverage.pixels_of.resize(contours.size());
  TruthTally tally;
  for (size_t i = 0; i < detection.chains.size(); ++i) {
    compare_chain(detection, i, nearest, contours, coverage, tally);
  }
  for (size_t c = 0; c < contours.size(); ++c) {
    Mean found;
    for (size_t k = 0; k < contours[c].points_px.size(); ++k) {
      if (contours[c].is_visible[k]) found.add(coverage.is_found[c][k]);
    }
    tally.found.merge(found);
    if (found.value() < 0.5) continue;
    const auto& chains = coverage.pixels_of[c];
    const long pieces = std::count_if(chains.begin(), chains.end(), [](const auto& chain) {
      return chain.second >= kLeastPixels;
    });
    tally.pieces.merge({static_cast<double>(pieces), static_cast<double>(contours[c].arcs())});
  }
  return tally;
}

}  // namespace berth::bench
