// See sweeps.hpp. About 60 M instructions altogether on the Arm target.
#include "sweeps.hpp"

#include "camera/projection.hpp"
#include "core/digest.hpp"
#include "fixed/linear.hpp"
#include "fixed/roots.hpp"
#include "fixed/trigonometry.hpp"
#include "fixed/vector.hpp"
#include "fixed/wide.hpp"

namespace berth_test {
namespace {

using berth::Digest;

// Numbers of every magnitude: xorshift64 (Marsaglia 2003), shifted right by a random amount.
class Numbers {
 public:
  std::uint64_t next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return state_;
  }
  std::uint32_t next32() { return static_cast<std::uint32_t>(next() >> 32); }
  std::int32_t signed32() {
    const auto number = static_cast<std::int32_t>(next32());
    return number >> (next32() & 31);
  }
  std::int64_t signed64(int bits) {
    const auto number = static_cast<std::int64_t>(next());
    return number >> (64 - bits + static_cast<int>(next32() % static_cast<unsigned>(bits)));
  }

 private:
  std::uint64_t state_ = 0x9e3779b97f4a7c15u;
};

// Steps through all 32-bit numbers, evenly, in 2^16 steps; the odd stride visits every residue.
constexpr std::uint32_t kSteps = 1u << 16;
std::uint32_t step32(std::uint32_t i) { return i * 0x10001u * 40503u; }

std::uint32_t sweep_products() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const auto a = berth::Q<28>::from_raw(numbers.signed32() >> 3);
    const auto b = berth::Q<18>::from_raw(numbers.signed32() >> 1);
    digest.add_signed((a * b).raw());
    digest.add_signed((b - b * a).raw());
    digest.add_signed(b.round());
    digest.add_signed(b.to_saturated<24>().raw());
  }
  return digest.value();
}

std::uint32_t sweep_quotients() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps / 4; ++i) {
    const auto b = berth::Q<18>::from_raw(numbers.signed32() | 1);
    const std::int32_t limit = b.raw() < 0 ? -(b.raw() + 1) : b.raw();
    const auto a = berth::Q<18>::from_raw(limit == 0 ? 0 : numbers.signed32() % limit);
    digest.add_signed(berth::div<30>(a, b).raw());
  }
  return digest.value();
}

std::uint32_t sweep_wide() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps / 4; ++i) {
    const std::int64_t a = numbers.signed64(62), b = numbers.signed64(62);
    const int bits = berth::bit_length(a) + berth::bit_length(b);
    const int shift = bits > 62 ? bits - 62 : 0;
    digest.add_wide(berth::mul_shift(a, b, shift));
    if (b == 0) continue;
    const int left = 61 + berth::bit_length(b) - berth::bit_length(a);
    digest.add_wide(berth::div_shift(a, left > 63 ? 63 : left, b));
  }
  return digest.value();
}

std::uint32_t sweep_roots() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const std::uint64_t value = numbers.next() >> (i & 63);
    digest.add(berth::isqrt(value));
    digest.add(berth::isqrt_nearest(value));
    const std::int32_t x = numbers.signed32(), y = numbers.signed32();
    digest.add(berth::hypot(x, y));
  }
  return digest.value();
}

std::uint32_t sweep_reciprocals() {
  Digest digest;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const std::uint32_t value = step32(i) >> (i % 32);
    const berth::Reciprocal r = berth::reciprocal(value | 1u);
    digest.add_signed(r.mantissa);
    digest.add_signed(r.shift);
  }
  return digest.value();
}

std::uint32_t sweep_sin_cos() {
  Digest digest;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const auto angle = berth::Angle::from_raw(static_cast<std::int32_t>(step32(i)));
    const berth::SinCos s = berth::sin_cos(angle);
    digest.add_signed(s.sin.raw());
    digest.add_signed(s.cos.raw());
  }
  return digest.value();
}

std::uint32_t sweep_arcs() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps / 4; ++i) {
    const std::int32_t y = numbers.signed32(), x = numbers.signed32();
    digest.add_signed(berth::atan2(y, x).raw());
    const auto value = berth::Unit::from_raw(static_cast<std::int32_t>(step32(i)));
    digest.add_signed(berth::asin(value).raw());
    digest.add_signed(berth::acos(value).raw());
  }
  return digest.value();
}

std::uint32_t sweep_vectors() {
  Digest digest;
  Numbers numbers;
  const auto unit_vector = [&numbers] {
    const berth::VectorQ<20> v{
        berth::Q<20>::from_raw(static_cast<std::int32_t>(numbers.next32()) >> 2),
        berth::Q<20>::from_raw(static_cast<std::int32_t>(numbers.next32()) >> 2),
        berth::Q<20>::from_raw(static_cast<std::int32_t>(numbers.next32() | 1u) >> 1)};
    return berth::normalized(v);
  };
  for (std::uint32_t i = 0; i < kSteps / 16; ++i) {
    const berth::Vec3Unit z = unit_vector();
    const berth::Vec3Unit x = berth::normalized(berth::cross<30>(z, unit_vector()));
    berth::Mat3Unit rotation;
    rotation << x, berth::cross<30>(z, x), z;
    const berth::Vec3Mm p{berth::Mm::from_raw(numbers.signed32() >> 3),
                          berth::Mm::from_raw(numbers.signed32() >> 3),
                          berth::Mm::from_raw(numbers.signed32() >> 3)};
    const berth::Vec3Mm eigen = rotation * p;
    const berth::Vec3Mm once = berth::rotate(rotation, p);
    for (int k = 0; k < 3; ++k) {
      digest.add_signed(eigen[k].raw());
      digest.add_signed(once[k].raw());
    }
    digest.add_signed(berth::norm(p).raw());
    digest.add_signed(berth::dot<30>(z, x).raw());
  }
  return digest.value();
}

// J^T J of a random integer J (8 x 6) with columns of very different scales.
void normal_matrix(Numbers& numbers, std::int64_t (&a)[6][6]) {
  std::int64_t jacobian[8][6];
  for (auto& row : jacobian) {
    for (int k = 0; k < 6; ++k) row[k] = numbers.signed64(28) >> (2 * k);
  }
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      a[i][j] = 0;
      for (const auto& row : jacobian) a[i][j] += row[i] * row[j];
    }
  }
}

std::uint32_t sweep_spd() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t n = 0; n < kSteps / 256; ++n) {
    std::int64_t a[6][6], b[6], x[6] = {};
    normal_matrix(numbers, a);
    for (std::int64_t& element : b) element = numbers.signed64(50);
    berth::SpdSystem<6> system;
    const bool is_definite = system.factor(a);
    digest.add(is_definite ? 1u : 0u);
    if (!is_definite) continue;
    digest.add(system.solve(b, x, 20) ? 1u : 0u);
    system.invert();
    for (int i = 0; i < 6; ++i) {
      digest.add_wide(x[i]);
      digest.add_wide(system.sigma(i, 13, 40));
      for (int j = 0; j < i; ++j) digest.add_signed(system.correlation(i, j).raw());
    }
  }
  return digest.value();
}

std::uint32_t sweep_eigenvectors() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t n = 0; n < kSteps / 256; ++n) {
    berth::Mat3Unit m;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        m(i, j) = berth::Unit::from_raw(static_cast<std::int32_t>(numbers.next32()) >> 2);
        m(j, i) = m(i, j);
      }
    }
    const berth::SymmetricEigen3 e = berth::decompose_symmetric(m);
    for (int i = 0; i < 3; ++i) {
      digest.add_signed(e.values[i].raw());
      for (int j = 0; j < 3; ++j) digest.add_signed(e.vectors(i, j).raw());
    }
  }
  return digest.value();
}

berth::Camera sweep_camera(std::uint32_t i) {
  berth::Camera camera;
  camera.width = camera.height = 1024;
  camera.fx = camera.fy = berth::q<16>(1250.0);
  camera.cx = berth::q<16>(515.3);
  camera.cy = berth::q<16>(508.7);
  camera.k1 = i % 2 == 0 ? berth::q<24>(-0.12) : berth::q<24>(9.5);
  camera.k2 = berth::q<24>(0.08);
  camera.p1 = berth::q<24>(0.0002);
  camera.p2 = berth::q<24>(-0.0003);
  camera.k3 = i % 3 == 0 ? berth::q<24>(0.01) : berth::q<24>(0.0);
  return camera;
}

// Also points far outside the image and very near, where results saturate.
std::uint32_t sweep_projection() {
  Digest digest;
  Numbers numbers;
  for (std::uint32_t i = 0; i < kSteps / 4; ++i) {
    const berth::Camera camera = sweep_camera(i);
    const auto z = static_cast<std::int32_t>((numbers.next32() >> (1 + i % 8)) | 1u);
    const berth::Vec3Mm point{berth::Mm::from_raw(numbers.signed32()),
                              berth::Mm::from_raw(numbers.signed32()), berth::Mm::from_raw(z)};
    const berth::Projection p = berth::project_with_jacobian(camera, point);
    for (int k = 0; k < 2; ++k) {
      digest.add_signed(p.pixel[k].raw());
      for (int j = 0; j < 3; ++j) digest.add_signed(p.by_point(k, j).raw());
    }
  }
  return digest.value();
}

std::uint32_t sweep_undistortion() {
  Digest digest;
  for (std::uint32_t i = 0; i < kSteps / 8; ++i) {
    const std::uint32_t place = step32(i);
    const berth::Vec2Px pixel{
        berth::Px::from_raw(static_cast<std::int32_t>((place & 0xffffu) << 10)),
        berth::Px::from_raw(static_cast<std::int32_t>((place >> 16) << 10))};
    const berth::Vec2Ray ray = berth::undistort(sweep_camera(2 * i), pixel);
    digest.add_signed(ray[0].raw());
    digest.add_signed(ray[1].raw());
  }
  return digest.value();
}

}  // namespace

const Sweep kSweeps[kSweepCount] = {
    {"products", sweep_products, 0xd79120fd},
    {"quotients", sweep_quotients, 0xafa3b18b},
    {"wide", sweep_wide, 0x4d54174c},
    {"roots", sweep_roots, 0xbbc0a576},
    {"reciprocals", sweep_reciprocals, 0xc5e6d721},
    {"sin_cos", sweep_sin_cos, 0xaf778dfb},
    {"arcs", sweep_arcs, 0x66a46729},
    {"vectors", sweep_vectors, 0x87a58095},
    {"spd", sweep_spd, 0xc5116ccf},
    {"eigenvectors", sweep_eigenvectors, 0x4bf2d44c},
    {"projection", sweep_projection, 0xa69a591e},
    {"undistortion", sweep_undistortion, 0x5ee06998},
};

}  // namespace berth_test
