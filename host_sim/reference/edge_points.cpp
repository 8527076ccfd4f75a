#include "host_sim/reference/edge_points.hpp"

#include <algorithm>
#include <cmath>

namespace berth::host {
namespace {

constexpr double kStep_px = 0.5;
constexpr int kLevelSamples = 3;
constexpr int kNeighbours = 3;
constexpr double kMinContrast = 8;  // of 100
// Beyond these levels there is a glint on the marker, or something bright beside it.
constexpr double kMaxBright = 130;
constexpr double kMaxDark = 30;

struct Profile {
  cv::Point2d origin, normal;  // normal from bright to dark
  std::vector<double> levels;
  double bright = 0, dark = 0;
};

double bilinear(const cv::Mat1f& image, const cv::Point2d& p) {
  const int x = static_cast<int>(std::floor(p.x));
  const int y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return std::nan("");
  const double fx = p.x - x;
  const double fy = p.y - y;
  return (1 - fy) * ((1 - fx) * image(y, x) + fx * image(y, x + 1)) +
         fy * ((1 - fx) * image(y + 1, x) + fx * image(y + 1, x + 1));
}

double mean(const std::vector<double>& v, std::size_t from, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += v[from + i];
  return sum / static_cast<double>(count);
}

Profile take_profile(const cv::Mat1f& flat, const cv::Point2d& origin, const cv::Point2d& normal,
                     const EdgeSearch& search) {
  Profile p;
  p.origin = origin;
  p.normal = normal;
  const int count = static_cast<int>((search.bright_px + search.dark_px) / kStep_px) + 1;
  for (int i = 0; i < count; ++i) {
    p.levels.push_back(bilinear(flat, origin + (i * kStep_px - search.bright_px) * normal));
  }
  if (p.levels.size() < 2 * kLevelSamples) return p;
  p.bright = mean(p.levels, 0, kLevelSamples);
  p.dark = mean(p.levels, p.levels.size() - kLevelSamples, kLevelSamples);
  return p;
}

std::vector<Profile> take_profiles(const cv::Mat1f& flat, const std::vector<cv::Point2d>& outline,
                                   const EdgeSearch& search) {
  const std::size_t n = outline.size();
  std::vector<Profile> profiles;
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_end = !search.is_closed && (i == 0 || i + 1 == n);
    const cv::Point2d& before = outline[is_end && i == 0 ? 0 : (i + n - 1) % n];
    const cv::Point2d& after = outline[is_end && i > 0 ? i : (i + 1) % n];
    const cv::Point2d tangent = (after - before) / cv::norm(after - before);
    const cv::Point2d outward(tangent.y, -tangent.x);
    profiles.push_back(
        take_profile(flat, outline[i], search.is_bright_inside ? outward : -outward, search));
  }
  return profiles;
}

/// Levels of profile i averaged with its neighbours'.
std::pair<double, double> smoothed_levels(const std::vector<Profile>& profiles, std::size_t i,
                                          bool is_closed) {
  double bright = 0;
  double dark = 0;
  int count = 0;
  const int n = static_cast<int>(profiles.size());
  for (int k = -kNeighbours; k <= kNeighbours; ++k) {
    int j = static_cast<int>(i) + k;
    if (!is_closed && (j < 0 || j >= n)) continue;
    j = (j + n) % n;
    const Profile& p = profiles[static_cast<std::size_t>(j)];
    if (!std::isfinite(p.bright) || !std::isfinite(p.dark)) continue;
    bright += p.bright;
    dark += p.dark;
    ++count;
  }
  return {bright / count, dark / count};
}

struct Crossing {
  double at_px = std::nan("");  ///< from the predicted outline towards dark; NaN: there is none
  double slope = 0;             ///< fall per px
};

Crossing find_crossing(const Profile& p, double middle, const EdgeSearch& search) {
  Crossing best;
  for (std::size_t i = 0; i + 1 < p.levels.size(); ++i) {
    const double a = p.levels[i];
    const double b = p.levels[i + 1];
    if (!(a >= middle && b < middle)) continue;
    const double at =
        (static_cast<double>(i) + (a - middle) / (a - b)) * kStep_px - search.bright_px;
    if (!(std::abs(at) >= std::abs(best.at_px))) best = {at, (a - b) / kStep_px};
  }
  return best;
}

double median_contrast(const std::vector<Profile>& profiles) {
  std::vector<double> contrasts;
  for (const Profile& p : profiles) {
    if (std::isfinite(p.bright - p.dark)) contrasts.push_back(p.bright - p.dark);
  }
  if (contrasts.empty()) return 0;
  const auto middle = contrasts.begin() + static_cast<std::ptrdiff_t>(contrasts.size() / 2);
  std::nth_element(contrasts.begin(), middle, contrasts.end());
  return *middle;
}

}  // namespace

LocatedEdge locate_edge(const cv::Mat1f& flat, const std::vector<cv::Point2d>& outline,
                        const EdgeSearch& search) {
  const std::vector<Profile> profiles = take_profiles(flat, outline, search);
  const double least = std::max(kMinContrast, 0.3 * median_contrast(profiles));
  LocatedEdge edge;
  double contrast = 0;
  double slope = 0;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const auto [bright, dark] = smoothed_levels(profiles, i, search.is_closed);
    if (!(bright - dark >= least) || bright > kMaxBright || dark > kMaxDark) continue;
    const Crossing crossing = find_crossing(profiles[i], (bright + dark) / 2, search);
    if (!std::isfinite(crossing.at_px)) continue;
    edge.points.push_back(profiles[i].origin + crossing.at_px * profiles[i].normal);
    contrast += bright - dark;
    slope += crossing.slope;
  }
  // An edge of Gaussian blur s falls by contrast / (sqrt(2 pi) s) per px in its middle.
  if (slope > 0) edge.blur_px = contrast / slope / std::sqrt(2 * CV_PI);
  return edge;
}

}  // namespace berth::host
