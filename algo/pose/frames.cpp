// See frames.hpp.
#include "pose/frames.hpp"

#include "fixed/scaled.hpp"
#include "pose/scaled_vector.hpp"

namespace berth {
namespace {

using Scaled6x6 = Scaled[6][6];

void expand(const PoseCovariance& in, Scaled6x6& out) {
  Scaled sigma[6];
  for (int i = 0; i < 3; ++i) {
    sigma[i] = Scaled(in.sigma_rotation[i]);
    sigma[3 + i] = Scaled(in.sigma_translation_mm[i]);
  }
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    out[i][i] = sigma[i] * sigma[i];
    for (int k = i + 1; k < 6; ++k) {
      out[i][k] = out[k][i] = sigma[i] * sigma[k] * Scaled(in.correlation[next++]);
    }
  }
}

PoseCovariance contract(const Scaled6x6& in) {
  PoseCovariance out;
  Scaled sigma[6];
  for (int i = 0; i < 6; ++i) sigma[i] = in[i][i] > Scaled() ? sqrt(in[i][i]) : Scaled();
  for (int i = 0; i < 3; ++i) {
    out.sigma_rotation[i] = sigma[i].to<28>();
    out.sigma_translation_mm[i] = sigma[3 + i].to<18>();
  }
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = i + 1; k < 6; ++k) {
      const bool is_known = !sigma[i].is_zero() && !sigma[k].is_zero();
      Unit r = is_known ? (in[i][k] / (sigma[i] * sigma[k])).to<30>() : Unit(0);
      r = r > Unit(1) ? Unit(1) : (r < Unit(-1) ? Unit(-1) : r);
      out.correlation[next++] = r;
    }
  }
  return out;
}

/// sum += J C J^T with J = [[A, 0], [B, A]]: A a rotation, B = -[lever]x A.
void add_transported(const Mat3Unit& rotation, const ScaledVector& lever,
                     const PoseCovariance& covariance, Scaled6x6& sum) {
  Scaled6x6 c, j, jc;
  expand(covariance, c);
  for (int k = 0; k < 3; ++k) {
    const ScaledVector a{Scaled(rotation(0, k)), Scaled(rotation(1, k)), Scaled(rotation(2, k))};
    const ScaledVector b = cross(a, lever);
    const Scaled* const column[2][3] = {{&a.x, &a.y, &a.z}, {&b.x, &b.y, &b.z}};
    for (int i = 0; i < 3; ++i) {
      j[i][k] = *column[0][i];
      j[3 + i][3 + k] = *column[0][i];
      j[3 + i][k] = *column[1][i];
    }
  }
  // The upper half of J is zero on the right; of the sum the upper triangle is read.
  const auto columns = [](int row) { return row < 3 ? 3 : 6; };
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) {
      Scaled entry;
      for (int m = 0; m < columns(i); ++m) entry += j[i][m] * c[m][k];
      jc[i][k] = entry;
    }
  }
  for (int i = 0; i < 6; ++i) {
    for (int k = i; k < 6; ++k) {
      for (int m = 0; m < columns(k); ++m) sum[i][k] += jc[i][m] * j[k][m];
    }
  }
}

/// R v for a vector of lengths, without rounding.
ScaledVector rotate(const Mat3Unit& rotation, const Vec3Mm& v) {
  const ScaledVector s = scaled_vector(v);
  const auto row = [&](int i) {
    return Scaled(rotation(i, 0)) * s.x + Scaled(rotation(i, 1)) * s.y +
           Scaled(rotation(i, 2)) * s.z;
  };
  return {row(0), row(1), row(2)};
}

}  // namespace

Quaternion quaternion_of(const Mat3Unit& m) {
  const Scaled xx(m(0, 0)), yy(m(1, 1)), zz(m(2, 2)), one(1);
  // Four times the square of each component, then the products with the largest.
  Scaled q[4] = {one + xx + yy + zz, one + xx - yy - zz, one - xx + yy - zz, one - xx - yy + zz};
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    if (q[i] > q[largest]) largest = i;
  }
  const auto sum = [&](int i, int k) { return Scaled(m(i, k)) + Scaled(m(k, i)); };
  const auto difference = [&](int i, int k) { return Scaled(m(i, k)) - Scaled(m(k, i)); };
  const Scaled products[4][4] = {{q[0], difference(2, 1), difference(0, 2), difference(1, 0)},
                                 {difference(2, 1), q[1], sum(0, 1), sum(0, 2)},
                                 {difference(0, 2), sum(0, 1), q[2], sum(1, 2)},
                                 {difference(1, 0), sum(0, 2), sum(1, 2), q[3]}};
  Scaled norm2;
  for (int i = 0; i < 4; ++i) {
    q[i] = products[largest][i];
    norm2 += q[i] * q[i];
  }
  const Scaled inverse = one / sqrt(norm2);
  Unit out[4];
  int sign = 0;
  for (int i = 0; i < 4; ++i) {
    out[i] = (q[i] * inverse).to<30>();
    if (sign == 0 && out[i].raw() != 0) sign = out[i].raw() < 0 ? -1 : 1;
  }
  if (sign < 0) {
    for (Unit& component : out) component = -component;
  }
  return {out[0], out[1], out[2], out[3]};
}

Mat3Unit rotation_of(const Quaternion& quaternion) {
  const Scaled w(quaternion.w), x(quaternion.x), y(quaternion.y), z(quaternion.z), one(1);
  const Scaled norm2 = w * w + x * x + y * y + z * z;
  BERTH_RANGE(!norm2.is_zero());
  const Scaled s = Scaled(2) / norm2;
  const auto symmetric = [&](const Scaled& a, const Scaled& b, const Scaled& c, const Scaled& d) {
    return (s * (a * b + c * d)).to<30>();
  };
  Mat3Unit m;
  m << (one - s * (y * y + z * z)).to<30>(), symmetric(x, y, -w, z), symmetric(x, z, w, y),
      symmetric(x, y, w, z), (one - s * (x * x + z * z)).to<30>(), symmetric(y, z, -w, x),
      symmetric(x, z, -w, y), symmetric(y, z, w, x), (one - s * (x * x + y * y)).to<30>();
  return m;
}

Mat3Unit orthonormalize(const Mat3Unit& rotation) {
  constexpr std::int64_t kOne = std::int64_t{1} << 60;
  Mat3Unit r = rotation;
  for (int step = 0; step < 3; ++step) {
    std::int64_t error[3][3];  // (R^T R - I) / 2, Q40
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        std::int64_t sum = i == k ? -kOne : 0;  // below 2^62
        for (int m = 0; m < 3; ++m) sum += std::int64_t{r(m, i).raw()} * r(m, k).raw();
        BERTH_RANGE(sum < kOne / 8 && sum > -kOne / 8);
        error[i][k] = shift_round(sum, 21);
      }
    }
    Mat3Unit next;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        std::int64_t correction = 0;  // Q54: errors below 1/16, shortened to Q34 first
        for (int m = 0; m < 3; ++m) {
          correction += shift_round(r(i, m).raw() * shift_round(error[m][k], 6), 10);
        }
        next(i, k) = Unit::saturated(r(i, k).raw() - shift_round(correction, 24));
      }
    }
    r = next;
  }
  return r;
}

Mat3Unit compose(const Mat3Unit& a, const Mat3Unit& b) {
  Mat3Unit out;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      std::int64_t sum = 0;  // below 3 * 2^60
      for (int m = 0; m < 3; ++m) sum += std::int64_t{a(i, m).raw()} * b(m, k).raw();
      out(i, k) = Unit::from_wide(shift_round(sum, 30));
    }
  }
  return out;
}

RigidTransform compose(const RigidTransform& a_from_b, const RigidTransform& b_from_c) {
  RigidTransform out;
  out.rotation = orthonormalize(compose(a_from_b.rotation, b_from_c.rotation));
  for (int i = 0; i < 3; ++i) {
    std::int64_t sum = 0;  // Q47: halves of Q48, below 3 * 2^60
    for (int k = 0; k < 3; ++k) {
      sum += shift_round(
          std::int64_t{a_from_b.rotation(i, k).raw()} * b_from_c.translation_mm[k].raw(), 1);
    }
    out.translation_mm[i] = Mm::saturated(shift_round(sum, 29) + a_from_b.translation_mm[i].raw());
  }
  return out;
}

RigidTransform inverse(const RigidTransform& a_from_b) {
  RigidTransform out;
  out.rotation = a_from_b.rotation.transpose();
  RigidTransform shift;
  shift.translation_mm = -a_from_b.translation_mm;
  const RigidTransform turned{out.rotation, Vec3Mm(Mm(0), Mm(0), Mm(0))};
  out.translation_mm = compose(turned, shift).translation_mm;
  return out;
}

RigidTransform effector_from_latch(const FrameChain& chain) {
  return compose(compose(chain.effector_from_camera, chain.camera_from_target),
                 chain.target_from_latch);
}

PoseCovariance transport_covariance(const FrameChain& chain, const ChainCovariance& covariance) {
  Scaled6x6 sum = {};
  const RigidTransform effector_from_target =
      compose(chain.effector_from_camera, chain.camera_from_target);
  const Mat3Unit& r_ec = chain.effector_from_camera.rotation;
  const Mat3Unit& r_et = effector_from_target.rotation;
  const ScaledVector latch_lever = rotate(r_et, chain.target_from_latch.translation_mm);
  if (covariance.camera_from_target != nullptr) {
    add_transported(r_ec, latch_lever, *covariance.camera_from_target, sum);
  }
  if (covariance.effector_from_camera != nullptr) {
    const ScaledVector camera_lever =
        latch_lever + rotate(r_ec, chain.camera_from_target.translation_mm);
    add_transported(Mat3Unit::Identity(), camera_lever, *covariance.effector_from_camera, sum);
  }
  if (covariance.target_from_latch != nullptr) {
    add_transported(r_et, ScaledVector{}, *covariance.target_from_latch, sum);
  }
  return contract(sum);
}

}  // namespace berth
