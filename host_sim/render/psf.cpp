#include "host_sim/render/psf.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/render/coverage.hpp"
#include "host_sim/render/det_math.hpp"

namespace berth::host {
namespace {

constexpr double kSampledFrom = 0.64;  // from here on samples have the exact variance to 1e-5
constexpr double kNegligible = 1e-7;   // weights below this part of the whole are left out

// I_n(v) by its power series.
double bessel_i(int n, double v) {
  double term = 1.0;
  for (int k = 1; k <= n; ++k) term *= 0.5 * v / k;
  double sum = 0.0;
  for (int k = 0; k < 1000 && term > sum * 1e-17; ++k) {
    sum += term;
    term *= (0.25 * v * v) / ((k + 1.0) * (n + k + 1.0));
  }
  return sum;
}

// Mirrors the half kernel h[0], h[1], ... and makes the sum one.
Kernel mirror(const std::vector<double>& half) {
  double sum = half[0];
  for (size_t i = 1; i < half.size(); ++i) sum += 2.0 * half[i];
  const size_t reach = half.size() - 1;
  Kernel kernel(2 * reach + 1);
  for (size_t i = 0; i <= reach; ++i) {
    kernel[reach + i] = kernel[reach - i] = static_cast<float>(half[i] / sum);
  }
  return kernel;
}

int reach_of(const Kernel& kernel) { return static_cast<int>(kernel.size() / 2); }

int reach_of(const std::vector<Tap>& taps) {
  int reach = 0;
  for (const Tap& tap : taps) reach = std::max({reach, std::abs(tap.dx), std::abs(tap.dy)});
  return reach;
}

void add_tap(std::vector<Tap>& taps, int along, int across, bool is_steep, double weight) {
  if (weight <= 0.0) return;
  const Tap tap{is_steep ? across : along, is_steep ? along : across, static_cast<float>(weight)};
  taps.push_back(tap);
}

// All products of two sparse kernels, equal offsets merged.
std::vector<Tap> combine(const std::vector<Tap>& a, const std::vector<Tap>& b) {
  if (a.empty()) return b;
  const int reach = reach_of(a) + reach_of(b);
  const int side = 2 * reach + 1;
  std::vector<double> sums(static_cast<size_t>(side) * side, 0.0);
  for (const Tap& p : a) {
    for (const Tap& q : b) {
      sums[static_cast<size_t>(p.dy + q.dy + reach) * side + (p.dx + q.dx + reach)] +=
          static_cast<double>(p.weight) * q.weight;
    }
  }
  std::vector<Tap> result;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double weight = sums[static_cast<size_t>(y) * side + x];
      if (weight > 0.0) result.push_back({x - reach, y - reach, static_cast<float>(weight)});
    }
  }
  return result;
}

}  // namespace

Kernel gaussian_kernel(double variance) {
  if (!(variance > 0.0)) return {1.0f};
  const bool is_wide = variance >= kSampledFrom;
  std::vector<double> half;
  for (int n = 0;; ++n) {
    const double value = is_wide ? det_exp(-0.5 * n * n / variance) : bessel_i(n, variance);
    if (n > 0 && value < kNegligible * half[0]) break;
    half.push_back(value);
  }
  return mirror(half);
}

Kernel box_kernel(double width) {
  std::vector<double> half;
  for (int i = 0; i == 0 || i - 0.5 < 0.5 * width; ++i) {
    const double inner = i == 0 ? 0.0 : i - 0.5;
    const double covered = std::min(0.5 * width, i + 0.5) - inner;
    half.push_back(i == 0 ? 2.0 * covered : covered);
  }
  if (half[0] <= 0.0) half = {1.0};
  return mirror(half);
}

// Masses at multiples of the spacing on the motion's longer axis; on the other axis each is shared
// between two cells. The outermost weight is chosen such that the variance along the motion is
// exact: 2 e + (2 n + 1) w = 1, 2 e (n + 1)^2 + w n (n + 1) (2 n + 1) / 3 = a^2 / 3.
MotionTaps motion_taps(double length_cells, double angle_rad, int spacing_cells) {
  const SinCos direction = det_sincos(angle_rad);
  const bool is_steep = std::abs(direction.sin) > std::abs(direction.cos);
  const double major = is_steep ? direction.sin : direction.cos;
  const double minor = is_steep ? direction.cos : direction.sin;
  const double slope = minor / major;
  const double a = 0.5 * length_cells * std::abs(major) / spacing_cells;  // half length in spacings
  MotionTaps result;
  if (!(a > 0.0)) return result;
  const double n = std::max(0.0, std::ceil(a - 0.5) - 1.0);
  const double count = 2.0 * n + 1.0;
  const double inner_variance = n * (n + 1.0) / 3.0;
  const double outer = (n + 1.0) * (n + 1.0);
  const double ends =
      std::clamp((a * a / 3.0 - inner_variance) / (outer - inner_variance), 0.0, 1.0);
  double excess = 0.0;
  for (int k = -static_cast<int>(n) - 1; k <= static_cast<int>(n) + 1; ++k) {
    const double weight = std::abs(k) > n ? 0.5 * ends : (1.0 - ends) / count;
    const int along = k * spacing_cells;
    const double across = std::abs(along) * slope;  // mirrored below, to be exactly symmetric
    const double floor = std::floor(across);
    const double share = across - floor;
    const int sign = k < 0 ? -1 : 1;
    add_tap(result.taps, along, sign * static_cast<int>(floor), is_steep, weight * (1.0 - share));
    add_tap(result.taps, along, sign * (static_cast<int>(floor) + 1), is_steep, weight * share);
    excess += weight * share * (1.0 - share);
  }
  (is_steep ? result.excess_x : result.excess_y) = excess;
  return result;
}

std::vector<Tap> disc_taps(double radius_cells) {
  if (radius_cells < 0.5) return {{0, 0, 1.0f}};
  constexpr int kVertices = 256;
  Polygon circle;
  for (int i = 0; i < kVertices; ++i) {
    const SinCos p = det_sincos(2.0 * kPi * i / kVertices);
    circle.emplace_back(radius_cells * p.cos, radius_cells * p.sin);
  }
  const int reach = static_cast<int>(std::ceil(radius_cells + 0.5));
  CoverageBuffer coverage;
  coverage.reset({-reach, -reach, 2 * reach + 1, 2 * reach + 1, 1});
  coverage.add_polygon(circle);
  coverage.resolve();
  double sum = 0.0;
  for (int y = 0; y <= 2 * reach; ++y) {
    for (int x = 0; x <= 2 * reach; ++x) sum += coverage.row(y)[x];
  }
  std::vector<Tap> taps;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      // The mean of mirrored cells, so that rounding leaves the kernel exactly symmetric.
      const float both = coverage.row(reach + y)[reach + x] + coverage.row(reach - y)[reach - x];
      if (both > 2e-6f) taps.push_back({x, y, static_cast<float>(0.5 * both / sum)});
    }
  }
  return taps;
}

Psf make_psf(const Optics& optics, int cells_per_px) {
  const double sigma = optics.defocus_px * cells_per_px;
  const int spacing = std::max(1, cells_per_px / 2);  // half a pixel: below every defocus' notice
  // Sharing a box or a disc between cells adds the variance of a cell.
  const double without_cell = std::max(0.0, sigma * sigma - 1.0 / 12.0);
  MotionTaps motion;
  if (optics.motion_px > 0.0) {
    motion = motion_taps(optics.motion_px * cells_per_px, optics.motion_angle_rad, spacing);
  }
  Psf psf;
  psf.taps = motion.taps;
  psf.x = psf.y = Kernel{1.0f};
  switch (optics.psf) {
    case PsfKind::kGaussian:
      psf.x = gaussian_kernel(std::max(0.0, sigma * sigma - motion.excess_x));
      psf.y = gaussian_kernel(std::max(0.0, sigma * sigma - motion.excess_y));
      break;
    case PsfKind::kBox:
      psf.x = psf.y = box_kernel(std::sqrt(12.0 * without_cell));
      break;
    case PsfKind::kDisc:
      psf.taps = combine(motion.taps, disc_taps(2.0 * std::sqrt(without_cell)));
      break;
  }
  psf.radius_cells = reach_of(psf.taps) + std::max(reach_of(psf.x), reach_of(psf.y));
  return psf;
}

}  // namespace berth::host
