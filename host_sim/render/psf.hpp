// Kernels of the optics: straight motion and defocus, on a grid of `cells_per_px` cells a pixel.
//
// Every kernel sums to one and is point-symmetric, so that no centroid moves; the variances are
// exact: what the interpolation of the motion adds is taken from the defocus.
#pragma once

#include <vector>

#include "host_sim/render/scene.hpp"

namespace berth::host {

/// One element of a kernel in two dimensions, offsets in cells.
struct Tap {
  int dx = 0;
  int dy = 0;
  float weight = 0;
};

/// A symmetric kernel in one dimension; the middle element has offset zero.
using Kernel = std::vector<float>;

/// The blur as two steps: a sparse kernel, then a separable one.
struct Psf {
  std::vector<Tap> taps;  ///< empty: nothing to do
  Kernel x;
  Kernel y;
  int radius_cells = 0;  ///< reach of both steps together
};

Psf make_psf(const Optics& optics, int cells_per_px);

/// A Gaussian of exact variance v >= 0 (cells^2): samples of the density; where it is too narrow
/// for them, its discrete analogue e^-v I_n(v) (Lindeberg 1990).
Kernel gaussian_kernel(double variance);

/// Exact area of a centred box of the given width in each cell.
Kernel box_kernel(double width);

/// Taps of uniform straight motion, and the variance in x and y that they add beyond it.
struct MotionTaps {
  std::vector<Tap> taps;
  double excess_x = 0;
  double excess_y = 0;
};
MotionTaps motion_taps(double length_cells, double angle_rad, int spacing_cells);

/// Taps of a disc of the given radius: exact area in each cell.
std::vector<Tap> disc_taps(double radius_cells);

}  // namespace berth::host
