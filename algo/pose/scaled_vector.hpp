// Three-vectors of Scaled for the minimal solver.
#pragma once

#include "fixed/eigen.hpp"
#include "fixed/scaled.hpp"

namespace berth {

struct ScaledVector {
  Scaled x, y, z;
};

template <int F>
ScaledVector scaled_vector(const Eigen::Matrix<Q<F>, 3, 1>& v) {
  return {Scaled(v[0]), Scaled(v[1]), Scaled(v[2])};
}

inline ScaledVector operator+(const ScaledVector& a, const ScaledVector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline ScaledVector operator-(const ScaledVector& a, const ScaledVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline ScaledVector operator*(const Scaled& s, const ScaledVector& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline Scaled dot(const ScaledVector& a, const ScaledVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline ScaledVector cross(const ScaledVector& a, const ScaledVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline ScaledVector unit(const ScaledVector& v) { return (Scaled(1) / sqrt(dot(v, v))) * v; }

}  // namespace berth
