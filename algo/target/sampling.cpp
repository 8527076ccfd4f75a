// See sampling.hpp.
#include "target/sampling.hpp"

#include "fixed/wide.hpp"

namespace berth {
namespace {

// Rotation by product: each of the products is rounded, as Eigen's are.
[[gnu::always_inline]] inline Vec3Mm face_point(const RigidTransform& t, Mm x, Mm y) {
  BERTH_RANGE(abs(x) < Mm(2048) && abs(y) < Mm(2048));
  Vec3Mm p;
  for (int i = 0; i < 3; ++i) {
    p[i] = Mm::from_raw(multiply_high(t.rotation(i, 0).raw(), 4 * x.raw())) +
           Mm::from_raw(multiply_high(t.rotation(i, 1).raw(), 4 * y.raw())) + t.translation_mm[i];
  }
  return p;
}

}  // namespace

Vec2Px TargetView::pixel(Mm x, Mm y) const {
  return project(camera, face_point(camera_from_target, x, y));
}

Vec2Px TargetView::pixel(const Vec3Mm& p) const {
  Vec3Mm point = face_point(camera_from_target, p[0], p[1]);
  for (int i = 0; i < 3; ++i) point[i] += camera_from_target.rotation(i, 2) * p[2];
  return project(camera, point);
}

Scan::Scan(const TargetView& view, Mm x, Mm y, Mm dx, Mm dy, int longest) : longest_(longest) {
  const Vec2Px middle = view.pixel(x, y);
  const Vec2Px a = view.pixel(x - dx, y - dy), b = view.pixel(x + dx, y + dy);
  for (int i = 0; i < 2; ++i) {
    const std::int32_t before = (a[i] - middle[i]).raw() >> 8;
    const std::int32_t after = (b[i] - middle[i]).raw() >> 8;
    const std::int32_t first = after - before, second = after + before;
    const std::int32_t most = 4096 * 256;  // longer than any image
    if (first > most || first < -most || second > most / 32 || second < -most / 32) return;
    (i == 0 ? x_ : y_) = {middle[i].raw(), first, second};
  }
  look_for_borders(view.image);
}

Scan Scan::moved(const ImageView& image, const Vec2Px& by) const {
  Scan scan = *this;
  scan.x_.middle = (middle()[0] + by[0]).raw();
  scan.y_.middle = (middle()[1] + by[1]).raw();
  scan.look_for_borders(image);
  return scan;
}

void Scan::look_for_borders(const ImageView& image) {
  is_inside_ = x_.is_inside(longest_, image.width) && y_.is_inside(longest_, image.height);
}

// Between pixels 0 and size - 1, of which the last has no neighbour to interpolate with.
bool Scan::Axis::is_inside(int longest, int size) const {
  const std::int32_t bend = (second < 0 ? -second : second) * longest >> 8;
  const std::int32_t reach = ((first < 0 ? -first : first) + bend + 1) * longest >> 1;
  return middle >= reach && middle < (size - 1) * (1 << Px::kFraction) - reach;
}

void Scan::read(const ImageView& image, int way, int count, Grey* level) const {
  BERTH_RANGE(is_inside_ && -longest_ <= way && way + (count - 1) * kStep <= longest_);
  // A place and what the next step adds, 20 fraction bits. All of it lies in the image: 2^30 for
  // the place and for each of its parts, but 2^31 for the square of 255.
  struct Walk {
    std::int32_t at, step, bend;
    Walk(const Axis& a, int way)
        : at(16 * a.middle + 8 * a.first * way + (a.second * way * way >> 5)),
          step(128 * a.first + a.second * (way + 8)),
          bend(16 * a.second) {}
    int pixel() const { return at >> 20; }
    int sixteenth() const { return at >> 16 & 15; }
    void advance() {
      at += step;
      step += bend;
    }
  };
  Walk x(x_, way), y(y_, way);
  for (Grey* const end = level + count; level != end; ++level) {
    *level = sample_inside(image, x.pixel(), y.pixel(), x.sixteenth(), y.sixteenth());
    x.advance();
    y.advance();
  }
}

}  // namespace berth
