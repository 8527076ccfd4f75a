#include "pose/outline_profile.hpp"

namespace berth {
namespace {

// All of this runs in the compiler only: the tables below are constants.
constexpr double root(double v) {
  double r = v > 1 ? v : 1;
  for (int i = 0; i < 60; ++i) r = 0.5 * (r + v / r);
  return r;
}

constexpr double exponential(double v) {  // v <= 0
  const double part = v / 64;
  double sum = 1, term = 1;
  for (int i = 1; i < 16; ++i) {
    term *= part / i;
    sum += term;
  }
  for (int i = 0; i < 6; ++i) sum *= sum;
  return sum;
}

constexpr double density(double x) { return 0.39894228040143267794 * exponential(-0.5 * x * x); }

// Phi(x) = 1/2 + phi(x) (x + x^3/3 + x^5/15 + ...), all terms of one sign.
constexpr double cumulative(double x) {
  const double a = x < 0 ? -x : x;
  if (a > 8) return x < 0 ? 0 : 1;
  double sum = a, term = a;
  for (int i = 1; i < 120; ++i) {
    term *= a * a / (2 * i + 1);
    sum += term;
  }
  const double half = density(a) * sum;
  return x < 0 ? 0.5 - half : 0.5 + half;
}

// Integral of Phi from minus infinity.
constexpr double ramp(double x) { return x * cumulative(x) + density(x); }

struct AllProfiles {
  EdgeProfile shapes[kProfileShapes] = {};
};

constexpr std::int16_t to_table(double v) {
  return static_cast<std::int16_t>(v * (1 << kProfileFraction) + 0.5);
}

constexpr AllProfiles make_profiles() {
  AllProfiles all;
  for (int s = 0; s < kProfileShapes; ++s) {
    const double f = static_cast<double>(s) / kProfileShapes;
    const double gauss = root(1 - f), half_width = root(3 * f);
    for (int i = 0; i < kProfileEntries; ++i) {
      const double x = (i - kProfileEntries / 2) / static_cast<double>(1 << kProfileStepsLog2);
      double step = cumulative(x);
      if (s > 0) {
        const double a = (x + half_width) / gauss, b = (x - half_width) / gauss;
        step = gauss * (ramp(a) - ramp(b)) / (2 * half_width);
      }
      all.shapes[s].step[i] = to_table(step);
    }
  }
  return all;
}

constexpr AllProfiles kProfiles = make_profiles();

}  // namespace

const EdgeProfile& edge_profile(int shape) { return kProfiles.shapes[shape]; }

}  // namespace berth
