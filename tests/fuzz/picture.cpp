#include "picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace berth::fuzz {
namespace {

constexpr std::size_t kHeaderOctets = 8, kCommandOctets = 16;
constexpr int kMaxCommands = 40;
constexpr double kPi = 3.14159265358979323846;

struct Size {
  int width, height;
};
// Mostly small, since small is fast; odd ones, and the largest.
constexpr std::array<Size, 8> kSizes = {
    {{256, 256}, {320, 240}, {257, 311}, {512, 512}, {128, 128}, {1024, 1024}, {64, 40}, {9, 7}}};

/// Octets of a command as numbers in a range.
class Octets {
 public:
  Octets(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  int at(std::size_t i) const { return i < size_ ? data_[i] : 0; }
  double in(std::size_t i, double low, double high) const {
    return low + (high - low) * at(i) / 255.0;
  }
  /// 16 bits, for what must be fine.
  double fine(std::size_t i, double low, double high) const {
    return low + (high - low) * (256 * at(i) + at(i + 1)) / 65535.0;
  }
  Octets after(std::size_t n) const {
    return {data_ + std::min(n, size_), size_ - std::min(n, size_)};
  }
  std::size_t size() const { return size_; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

Mm mm(double v) { return Mm::from_raw(static_cast<std::int32_t>(std::lround(v * 262144))); }
Px px(double v) { return Px::from_raw(static_cast<std::int32_t>(std::lround(v * 65536))); }

Vec3Mm point(double x, double y, double z) { return {mm(x), mm(y), mm(z)}; }

TargetModel make_target(double scale, bool is_flat, bool white_on_black) {
  TargetModel t;
  t.plate_width_mm = t.plate_height_mm = mm(120 * scale);
  t.white_on_black = white_on_black;
  t.ring_outer_mm = mm(30 * scale);
  t.ring_inner_mm = mm(24 * scale);
  t.line_x_mm = mm(0);
  t.line_y_mm = mm(45 * scale);
  t.line_length_mm = mm(56 * scale);
  t.line_width_mm = mm(6 * scale);
  if (!is_flat) {
    Dot& d = t.dots[t.dot_count++];
    d.center_mm = point(0, 0, -20 * scale);
    d.radius_mm = mm(6 * scale);
    d.collar_radius_mm = mm(9 * scale);
    d.post_radius_mm = mm(3 * scale);
  }
  for (int k = 0; k < 4; ++k) {
    Dot& d = t.dots[t.dot_count++];
    d.center_mm = point((k % 2 ? 45 : -45) * scale, (k / 2 ? 45 : -45) * scale, 0);
    d.radius_mm = mm(6 * scale);
  }
  return t;
}

Camera make_camera(const Size& size, int distortion) {
  Camera c;
  c.width = size.width;
  c.height = size.height;
  c.fx = c.fy = px(std::max(16.0, 1.22 * std::max(size.width, size.height)));
  c.cx = px(0.503 * size.width);
  c.cy = px(0.497 * size.height);
  if (distortion > 64) {
    c.k1 = q<24>(-0.12);
    c.k2 = q<24>(0.08);
    c.p1 = q<24>(0.0002);
    c.p2 = q<24>(-0.0003);
  }
  return c;
}

double to_mm(Mm v) { return v.raw() / 262144.0; }

/// A canvas of grey levels that shapes are drawn on.
class Canvas {
 public:
  Canvas(const Size& size, double level)
      : size_(size), levels_(static_cast<std::size_t>(size.width * size.height), level) {}

  /// level(x, y, old) for every pixel.
  template <typename Level>
  void paint(Level level) {
    std::size_t i = 0;
    for (int y = 0; y < size_.height; ++y) {
      for (int x = 0; x < size_.width; ++x, ++i) levels_[i] = level(x, y, levels_[i]);
    }
  }

  void blur() {
    for (int pass = 0; pass < 2; ++pass) {
      const std::vector<double> in = levels_;
      const int step = pass == 0 ? 1 : size_.width;
      for (std::size_t i = static_cast<std::size_t>(step); i + step < in.size(); ++i) {
        levels_[i] = 0.25 * in[i - step] + 0.5 * in[i] + 0.25 * in[i + step];
      }
    }
  }

  double width() const { return size_.width; }
  double height() const { return size_.height; }
  const std::vector<double>& levels() const { return levels_; }

 private:
  Size size_;
  std::vector<double> levels_;
};

void draw_rectangle(const Octets& o, Canvas& canvas) {
  const double cx = o.fine(1, 0, canvas.width()), cy = o.fine(3, 0, canvas.height());
  const double a = o.in(5, 0.5, 0.6 * canvas.width()), b = o.in(6, 0.5, 0.3 * canvas.height());
  const double turn = o.in(7, 0, 2 * kPi), level = o.at(8);
  const double c = std::cos(turn), s = std::sin(turn);
  canvas.paint([&](int x, int y, double old) {
    const double u = c * (x - cx) + s * (y - cy), v = c * (y - cy) - s * (x - cx);
    return std::abs(u) < a && std::abs(v) < b ? level : old;
  });
}

void draw_ring(const Octets& o, Canvas& canvas) {
  const double cx = o.fine(1, 0, canvas.width()), cy = o.fine(3, 0, canvas.height());
  const double a = o.in(5, 1, 0.6 * canvas.width()), flat = o.in(6, 0.2, 1.0);
  const double turn = o.in(7, 0, 2 * kPi), level = o.at(8), hole = o.in(9, -0.2, 1.0);
  const double c = std::cos(turn), s = std::sin(turn);
  canvas.paint([&](int x, int y, double old) {
    const double u = c * (x - cx) + s * (y - cy), v = (c * (y - cy) - s * (x - cx)) / flat;
    const double r = std::sqrt(u * u + v * v) / a;
    return r < 1 && r > hole ? level : old;
  });
}

void draw_waves(const Octets& o, Canvas& canvas) {
  const double cx = o.fine(1, 0, canvas.width()), cy = o.fine(3, 0, canvas.height());
  const double period = o.in(5, 1.5, 80), swing = o.in(6, 0, 200), turn = o.in(7, 0, 2 * kPi);
  const int shape = o.at(8) % 3;
  const double c = std::cos(turn), s = std::sin(turn);
  canvas.paint([&](int x, int y, double old) {
    const double u = c * (x - cx) + s * (y - cy), v = c * (y - cy) - s * (x - cx);
    const double phase = shape == 0 ? u : std::sqrt(u * u + v * v);
    const double wave = std::sin(2 * kPi * phase / period);
    if (shape < 2) return old + swing * wave;
    return old + (wave * std::sin(2 * kPi * v / period) > 0 ? swing : -swing);
  });
}

void change_levels(const Octets& o, Canvas& canvas) {
  const double gain = o.in(1, -3, 3), offset = o.in(2, -255, 255);
  const double gx = o.in(3, -300, 300) / canvas.width(), gy = o.in(4, -300, 300) / canvas.height();
  canvas.paint([&](int x, int y, double old) { return gain * old + offset + gx * x + gy * y; });
}

void draw_raw(const Octets& o, Canvas& canvas) {
  const int x0 = static_cast<int>(o.in(1, 0, canvas.width()));
  const int y0 = static_cast<int>(o.in(2, 0, canvas.height()));
  const int cell = 1 + o.at(3) % 16;
  canvas.paint([&](int x, int y, double old) {
    const int i = (x - x0) / cell, j = (y - y0) / cell;
    if (x < x0 || y < y0 || i >= 4 || j >= 3) return old;
    return static_cast<double>(o.at(static_cast<std::size_t>(4 + 4 * j + i)));
  });
}

struct Stamp {
  const TargetModel& target;
  double rotation[3][3];
  double translation[3];
  double fx, cx, cy;

  /// Where the line of sight through a pixel meets the plane at z of the target: x and y there.
  bool meet(int u, int v, double z, double& x, double& y) const {
    const double ray[3] = {(u - cx) / fx, (v - cy) / fx, 1};
    double origin[3], direction[3];
    for (int k = 0; k < 3; ++k) {
      origin[k] = direction[k] = 0;
      for (int i = 0; i < 3; ++i) {
        origin[k] -= rotation[i][k] * translation[i];
        direction[k] += rotation[i][k] * ray[i];
      }
    }
    if (std::abs(direction[2]) < 1e-6) return false;
    const double s = (z - origin[2]) / direction[2];
    x = origin[0] + s * direction[0];
    y = origin[1] + s * direction[1];
    return s > 0;
  }

  /// 1 white, 0 black, -1 not the plate.
  int colour(int u, int v) const {
    double x, y;
    const Dot& d0 = target.dots[0];
    if (target.has_raised_dot() && meet(u, v, to_mm(d0.center_mm[2]), x, y)) {
      const double r = std::hypot(x - to_mm(d0.center_mm[0]), y - to_mm(d0.center_mm[1]));
      if (r < to_mm(d0.collar_radius_mm)) return r < to_mm(d0.radius_mm) ? 1 : 0;
    }
    if (!meet(u, v, 0, x, y)) return -1;
    if (std::abs(x) > to_mm(target.plate_width_mm) / 2) return -1;
    if (std::abs(y) > to_mm(target.plate_height_mm) / 2) return -1;
    const double r = std::hypot(x, y);
    if (r < to_mm(target.ring_outer_mm) && r > to_mm(target.ring_inner_mm)) return 1;
    if (std::abs(x - to_mm(target.line_x_mm)) < to_mm(target.line_length_mm) / 2 &&
        std::abs(y - to_mm(target.line_y_mm)) < to_mm(target.line_width_mm) / 2) {
      return 1;
    }
    for (int i = target.has_raised_dot() ? 1 : 0; i < target.dot_count; ++i) {
      const Dot& d = target.dots[i];
      if (std::hypot(x - to_mm(d.center_mm[0]), y - to_mm(d.center_mm[1])) < to_mm(d.radius_mm)) {
        return 1;
      }
    }
    return 0;
  }
};

void draw_target(const Octets& o, const Parameters& parameters, Canvas& canvas) {
  const double plate = to_mm(parameters.target.plate_width_mm);
  const double fx = parameters.camera.fx.raw() / 65536.0;
  const double z = plate * o.fine(1, 0.6, 14);
  const double turn = o.in(3, 0, 2 * kPi), tilt = o.in(4, -1.4, 1.4), axis = o.in(5, 0, kPi);
  // Rz(axis) Rx(tilt) Rz(turn - axis)
  const double ca = std::cos(axis), sa = std::sin(axis), ct = std::cos(tilt), st = std::sin(tilt);
  const double cr = std::cos(turn - axis), sr = std::sin(turn - axis);
  const double u = o.fine(6, -0.2, 1.2) * canvas.width();
  const double v = o.fine(8, -0.2, 1.2) * canvas.height();
  const double cx = parameters.camera.cx.raw() / 65536.0;
  const double cy = parameters.camera.cy.raw() / 65536.0;
  const Stamp stamp{parameters.target,
                    {{ca * cr - sa * ct * sr, -ca * sr - sa * ct * cr, sa * st},
                     {sa * cr + ca * ct * sr, -sa * sr + ca * ct * cr, -ca * st},
                     {st * sr, st * cr, ct}},
                    {z * (u - cx) / fx, z * (v - cy) / fx, z},
                    fx,
                    cx,
                    cy};
  const bool swap = !parameters.target.white_on_black;
  const double white = o.at(10), black = o.at(11);
  canvas.paint([&](int x, int y, double old) {
    const int colour = stamp.colour(x, y);
    return colour < 0 ? old : ((colour == 1) != swap ? white : black);
  });
}

void draw(const Octets& o, const Parameters& parameters, Canvas& canvas) {
  switch (o.at(0) % 8) {
    case 0:
      return draw_rectangle(o, canvas);
    case 1:
      return draw_ring(o, canvas);
    case 2:
      return draw_waves(o, canvas);
    case 3:
      return change_levels(o, canvas);
    case 4:
      return draw_raw(o, canvas);
    case 5:
      return canvas.blur();
    default:
      return draw_target(o, parameters, canvas);
  }
}

// Noise that depends on the input's first octets; sum of three uniform numbers.
void add_noise(const Octets& header, Canvas& canvas) {
  const double swing = header.in(4, 0, 1) * header.in(4, 0, 1) * 120;
  std::uint32_t state = 0x9e3779b9u + static_cast<std::uint32_t>(header.at(5));
  const auto uniform = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) / 16777216.0 - 0.5;
  };
  canvas.paint(
      [&](int, int, double old) { return old + swing * (uniform() + uniform() + uniform()); });
}

}  // namespace

Picture decode_picture(const std::uint8_t* data, std::size_t size) {
  const Octets header(data, size);
  const Size image = kSizes[static_cast<std::size_t>(header.at(0)) % kSizes.size()];
  constexpr double kScales[4] = {1, 0.25, 4, 1.5};
  Picture picture;
  const int kind = header.at(1);
  picture.parameters.camera = make_camera(image, header.at(2));
  picture.parameters.target = make_target(kScales[kind >> 4 & 3], (kind & 2) != 0, (kind & 1) == 0);
  Canvas canvas(image, header.at(3));
  Octets rest = header.after(kHeaderOctets);
  for (int n = 0; n < kMaxCommands && rest.size() > 0; ++n) {
    draw(rest, picture.parameters, canvas);
    rest = rest.after(kCommandOctets);
  }
  for (int n = 0; n < header.at(6) % 6; ++n) canvas.blur();
  add_noise(header, canvas);
  picture.width = image.width;
  picture.height = image.height;
  for (const double level : canvas.levels()) {
    // Waves and gains may pile up to anything.
    const double clipped = level > 0 ? std::min(level, 255.0) : 0.0;
    picture.pixels.push_back(static_cast<std::uint8_t>(clipped + 0.5));
  }
  return picture;
}

}  // namespace berth::fuzz
