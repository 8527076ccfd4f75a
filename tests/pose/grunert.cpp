#include "grunert.hpp"

#include <cmath>

namespace berth::test {
namespace {

using Vector = Eigen::Matrix<long double, 3, 1>;
using Matrix = Eigen::Matrix<long double, 3, 3>;

struct Problem {
  Vector f[3], x[3];
};

Problem problem_of(const Eigen::Vector3d (&bearing)[3], const Eigen::Vector3d (&point_mm)[3]) {
  Problem p;
  for (int i = 0; i < 3; ++i) {
    p.f[i] = bearing[i].cast<long double>().normalized();
    p.x[i] = point_mm[i].cast<long double>();
  }
  return p;
}

bool newton(const Problem& p, Vector& s) {
  const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int step = 0; step < 30; ++step) {
    Vector r;
    Matrix j = Matrix::Zero();
    for (int e = 0; e < 3; ++e) {
      const int a = pairs[e][0], b = pairs[e][1];
      const Vector d = s[a] * p.f[a] - s[b] * p.f[b];
      r[e] = d.squaredNorm() - (p.x[a] - p.x[b]).squaredNorm();
      j(e, a) = 2 * d.dot(p.f[a]);
      j(e, b) = -2 * d.dot(p.f[b]);
    }
    const Vector delta = j.fullPivLu().solve(r);
    if (!delta.allFinite()) return false;
    s -= delta;
    if (delta.norm() < 1e-17L * s.norm()) return true;
  }
  return true;  // as near as a double root lets it come; the caller compares
}

PoseD align(const Problem& p, const Vector& s) {
  const auto triad = [](const Vector& a, const Vector& b, const Vector& c) {
    Matrix m;
    m.col(0) = (b - a).normalized();
    m.col(2) = (b - a).cross(c - a).normalized();
    m.col(1) = m.col(2).cross(m.col(0));
    return m;
  };
  const Matrix r = triad(s[0] * p.f[0], s[1] * p.f[1], s[2] * p.f[2]) *
                   triad(p.x[0], p.x[1], p.x[2]).transpose();
  PoseD pose;
  pose.rotation = r.cast<double>();
  const Vector t =
      (s[0] * p.f[0] + s[1] * p.f[1] + s[2] * p.f[2] - r * (p.x[0] + p.x[1] + p.x[2])) / 3;
  pose.translation_mm = t.cast<double>();
  return pose;
}

}  // namespace

std::vector<PoseD> solve_grunert(const Eigen::Vector3d (&bearing)[3],
                                 const Eigen::Vector3d (&point_mm)[3]) {
  const Problem p = problem_of(bearing, point_mm);
  const auto squared = [&](int i, int k) {
    return static_cast<double>((p.x[i] - p.x[k]).squaredNorm());
  };
  const auto cosine = [&](int i, int k) { return static_cast<double>(p.f[i].dot(p.f[k])); };
  const double a2 = squared(1, 2), b2 = squared(0, 2), c2 = squared(0, 1);
  const double ca = cosine(1, 2), cb = cosine(0, 2), cg = cosine(0, 1);
  const double m = (a2 - c2) / b2, n = (a2 + c2) / b2;
  const double a4 = (m - 1) * (m - 1) - 4 * c2 / b2 * ca * ca;
  const double a3 = 4 * (m * (1 - m) * cb - (1 - n) * ca * cg + 2 * c2 / b2 * ca * ca * cb);
  const double a_2 = 2 * (m * m - 1 + 2 * m * m * cb * cb + 2 * (b2 - c2) / b2 * ca * ca -
                          4 * n * ca * cb * cg + 2 * (b2 - a2) / b2 * cg * cg);
  const double a1 = 4 * (-m * (1 + m) * cb + 2 * a2 / b2 * cg * cg * cb - (1 - n) * ca * cg);
  const double a0 = (1 + m) * (1 + m) - 4 * a2 / b2 * cg * cg;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  companion.diagonal(-1).setOnes();
  companion.col(3) << -a0 / a4, -a1 / a4, -a_2 / a4, -a3 / a4;
  const Eigen::Vector4cd roots = companion.eigenvalues();
  std::vector<PoseD> poses;
  for (int i = 0; i < 4; ++i) {
    const double v = roots[i].real();
    if (std::abs(roots[i].imag()) > 1e-4 || v <= 0) continue;
    const double u = ((m - 1) * v * v - 2 * m * cb * v + 1 + m) / (2 * (cg - v * ca));
    const double s1 = std::sqrt(b2 / (1 + v * v - 2 * v * cb));
    Vector s(s1, u * s1, v * s1);
    if (newton(p, s) && s.minCoeff() > 0) poses.push_back(align(p, s));
  }
  return poses;
}

bool refine_distances(const Eigen::Vector3d (&bearing)[3], const Eigen::Vector3d (&point_mm)[3],
                      const PoseD& start, PoseD& out) {
  const Problem p = problem_of(bearing, point_mm);
  Vector s;
  for (int i = 0; i < 3; ++i) {
    s[i] = (start.rotation * point_mm[i] + start.translation_mm).norm();
  }
  if (!newton(p, s)) return false;
  out = align(p, s);
  out.tilt_rad = start.tilt_rad;
  return true;
}

}  // namespace berth::test
