#include "accuracy/outline_twin.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "host_sim/io/camera_model.hpp"
#include "host_sim/render/outline.hpp"

namespace berth::accuracy {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kPose = 6, kOffset = 3, kBlur = 3, kUnknowns = kPose + kOffset + kBlur;
using Row = Eigen::Matrix<double, kUnknowns + 2, 1>;  // the sector's black and contrast last
using Normal = Eigen::Matrix<double, kUnknowns + 2, kUnknowns + 2>;

struct Piece {
  std::function<Eigen::Vector3d(double)> at;     // 0 <= s <= segments
  std::function<Eigen::Vector3d(double)> white;  // direction towards white
  int segments;
  double width_mm;
  double opposite_curvature;  // of the opposite edge over this one's: 1, -1 or 0
};
using Sector = std::vector<Piece>;

Piece arc(const Eigen::Vector3d& center, double radius, double first, double step, int segments,
          bool is_hole, double width, double opposite) {
  const auto angle = [=](double s) { return first + s * step; };
  return {[=](double s) -> Eigen::Vector3d {
            return center + radius * Eigen::Vector3d(std::cos(angle(s)), std::sin(angle(s)), 0);
          },
          [=](double s) -> Eigen::Vector3d {
            return (is_hole ? 1.0 : -1.0) *
                   Eigen::Vector3d(std::cos(angle(s)), std::sin(angle(s)), 0);
          },
          segments, width, opposite};
}

Piece straight(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& white,
               int segments, double width) {
  return {[=](double s) -> Eigen::Vector3d {
            const Eigen::Vector2d p = a + (b - a) * s / segments;
            return {p.x(), p.y(), 0};
          },
          [=](double) -> Eigen::Vector3d {
            return {white.x(), white.y(), 0};
          },
          segments, width, 0};
}

// Sectors as of the flight code at 300 mm; `corner_mm` is left out at the ends of straight edges.
std::vector<Sector> sectors_of(const host::Target& target, double corner_mm) {
  std::vector<Sector> all;
  for (const host::Dot& d : target.dots) {
    all.push_back({arc({d.center[0], d.center[1], d.center[2]}, d.radius, 0, 2 * kPi / 16, 16,
                       false, 2 * d.radius, 1)});
  }
  const double width = target.ring.outer - target.ring.inner;
  for (int k = 0; k < 16; ++k) {
    const double first = 2 * kPi / 16 * k, step = 2 * kPi / 32;
    all.push_back({arc({0, 0, 0}, target.ring.outer, first, step, 2, false, width, -1),
                   arc({0, 0, 0}, target.ring.inner, first, step, 2, true, width, -1)});
  }
  const host::Line& line = target.line;  // along x
  const double half = 0.5 * line.length - corner_mm, part = half / 2;
  const double y0 = line.center[1] - 0.5 * line.width, y1 = line.center[1] + 0.5 * line.width;
  for (int k = 0; k < 4; ++k) {
    const double x0 = line.center[0] - half + k * part, x1 = x0 + part;
    Sector sector{straight({x0, y0}, {x1, y0}, {0, 1}, 2, line.width),
                  straight({x1, y1}, {x0, y1}, {0, -1}, 2, line.width)};
    const double end = line.center[0] + (k == 0 ? -0.5 : 0.5) * line.length;
    const double a = y0 + corner_mm, b = y1 - corner_mm;
    if ((k == 0 || k == 3) && b - a > line.width / 8) {
      sector.push_back(straight({end, a}, {end, b}, {k == 0 ? 1.0 : -1.0, 0}, 2, line.length));
    }
    all.push_back(std::move(sector));
  }
  return all;
}

double cumulative(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }
double density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * kPi); }

// The step blurred by a Gaussian of variance 1 - f and a box of variance f.
struct Step {
  double value, slope;
};
Step blurred_step(double x, double f) {
  if (f < 1.0 / 16) return {cumulative(x), density(x)};
  const double g = std::sqrt(1 - f), half = std::sqrt(3 * f);
  const double a = (x + half) / g, b = (x - half) / g;
  const auto ramp = [](double z) { return z * cumulative(z) + density(z); };
  return {g * (ramp(a) - ramp(b)) / (2 * half), (cumulative(a) - cumulative(b)) / (2 * half)};
}

// Where an outline is crossed and how it runs there.
struct Crossing {
  Eigen::Vector2d point, normal;
  double curvature, width_px;
  Vector6 jacobian;  // of the displacement along the normal
};

class Twin {
 public:
  explicit Twin(const TwinInput& input)
      : in_(input),
        pose_(input.start),
        black_(25, input.black),
        contrast_(25, input.white - input.black) {}

  void round(bool judge) {
    judge_ = judge;
    const double scale = in_.camera.fx / pose_.t.z();
    const double corner_px = 3 * std::sqrt(std::max(blur_[0], blur_[2])) + 0.5;
    const std::vector<Sector> sectors = sectors_of(in_.target, corner_px / scale);
    a_.setZero();
    b_.setZero();
    squares_.clear();
    square_ = weight_ = 0;
    for (size_t k = 0; k < sectors.size(); ++k) measure_sector(sectors[k], k);
    const double variance = square_ / (weight_ - 2.0 * static_cast<double>(sectors.size()) - 12);
    for (int k = 0; k < kOffset; ++k) {
      a_(kPose + k, kPose + k) += variance / 0.09;
      b_[kPose + k] -= variance / 0.09 * offset_[k];
    }
    const Eigen::Matrix<double, kUnknowns, 1> x = a_.ldlt().solve(b_);
    pose_ = moved(pose_, x.head<6>());
    offset_ += x.segment<3>(kPose);
    blur_ += x.tail<3>();
    std::nth_element(squares_.begin(), squares_.begin() + static_cast<long>(squares_.size() / 2),
                     squares_.end());
    ordinary_ = squares_[squares_.size() / 2];
    covariance_ = variance * a_.inverse().topLeftCorner<6, 6>();
  }

  TwinResult result() const { return {pose_, covariance_, blur_}; }

 private:
  Eigen::Vector2d place(const Piece& piece, double s) const {
    return host::project_point({in_.camera, pose_}, piece.at(s));
  }

  Crossing cross(const Piece& piece, double s) const {
    constexpr double h = 1e-3;
    Crossing c;
    c.point = place(piece, s);
    const Eigen::Vector2d before = place(piece, s - h), after = place(piece, s + h);
    const Eigen::Vector2d tangent = (after - before) / (2 * h);
    const Eigen::Vector2d bend = (after - 2 * c.point + before) / (h * h);
    const host::View view{in_.camera, pose_};
    const Eigen::Vector3d p = piece.at(s);
    const Eigen::Vector2d white =
        (host::project_point(view, p + 1e-3 * piece.white(s)) - c.point) / 1e-3;
    c.normal = Eigen::Vector2d(-tangent.y(), tangent.x()).normalized();
    if (c.normal.dot(white) < 0) c.normal = -c.normal;
    c.curvature = bend.dot(c.normal) / tangent.squaredNorm();
    c.width_px = piece.width_mm * c.normal.dot(white);
    for (int k = 0; k < 6; ++k) {
      Vector6 step = Vector6::Zero();
      step[k] = k < 3 ? 1e-6 : 1e-4;
      c.jacobian[k] = c.normal.dot(host::project_point({in_.camera, moved(pose_, step)}, p) -
                                   host::project_point({in_.camera, moved(pose_, -step)}, p)) /
                      (2 * step[k]);
    }
    return c;
  }

  // One station: its pixels' rows and residuals added with the station's robust weight.
  struct Station {
    Normal a = Normal::Zero();
    Row b = Row::Zero();
    double pull = 0, grip = 0, square = 0;  // sums of p r, p p, r r
    int pixels = 0;
  };

  Station measure_station(const Piece& piece, const Crossing& mid, const Crossing& c, int axis,
                          int line, size_t sector) const {
    Station out;
    const Eigen::Vector2d n = c.normal;
    const double cos_2 = n.x() * n.x() - n.y() * n.y(), sin_2 = 2 * n.x() * n.y();
    const Eigen::Vector3d eta(n.x() * n.x(), 2 * n.x() * n.y(), n.y() * n.y());
    const double across = eta.dot(blur_), along = blur_[0] + blur_[2] - across;
    const double mean = 0.5 * (blur_[0] + blur_[2]);
    const double floor = mean - std::hypot(0.5 * (blur_[0] - blur_[2]), blur_[1]);
    const double kappa = c.curvature, moved_along = std::max(0.0, along - floor);
    const double wide =
        std::sqrt(across + std::pow(kappa * along, 2) / 2 - 0.3 * std::pow(kappa * moved_along, 2));
    const double s = std::sqrt(across), f = std::max(0.0, across - floor) / across;
    const double offset = offset_.dot(Eigen::Vector3d(1, cos_2, sin_2)) * s;
    const double pulse =
        (c.width_px + 2 * offset - (1 + piece.opposite_curvature) * kappa * along / 2) / wide;
    const double n_u = n[1 - axis], t_uu = 1 - n_u * n_u, u = c.point[1 - axis];
    const double steep = std::abs(mid.normal[1 - axis]);
    const double reach = std::min(8.5, 2.7 * wide + 0.5) / steep;
    double inside = std::min(reach, c.width_px / 2 / steep), outside = reach;
    double& hollow = kappa > 0 ? inside : outside;
    const double wedge = std::max(0.0, std::abs(n_u) - std::sqrt(t_uu));
    hollow = std::min(hollow, wedge / std::abs(kappa));
    const auto first = static_cast<int>(std::ceil(u - (n_u > 0 ? outside : inside)));
    const auto last = static_cast<int>(std::floor(u + (n_u > 0 ? inside : outside)));
    if (last - first < 2) return out;
    const double contrast = contrast_[sector];
    for (int i = first; i <= last; ++i) {
      const double e = i - u;
      const double d =
          e * n_u - kappa / 2 * t_uu * e * e - kappa * kappa / 2 * n_u * t_uu * e * e * e;
      const double x = (d - kappa * along / 2 + offset) / wide;
      Step p = blurred_step(x, f);
      double h = p.slope * x;
      if (pulse < 7) {
        const Step other = blurred_step(pulse - x, f);
        p.value += other.value - 1;
        p.slope -= other.slope;
        h += other.slope * (pulse - x);
      }
      const int column = axis == 1 ? i : line, row = axis == 1 ? line : i;
      const double r = in_.image.data[static_cast<size_t>(row * in_.image.width + column)] -
                       (black_[sector] + contrast * p.value);
      Row g;
      g.head<6>() = -contrast / wide * p.slope * mid.jacobian;
      g.segment<3>(kPose) = contrast * p.slope * s / wide * Eigen::Vector3d(1, cos_2, sin_2);
      g.segment<3>(kPose + kOffset) = -contrast * h / (2 * across) * eta;
      g.tail<2>() << 1, p.value;
      out.a += g * g.transpose();
      out.b += g * r;
      out.pull += p.slope * r;
      out.grip += p.slope * p.slope;
      out.square += r * r;
      ++out.pixels;
    }
    return out;
  }

  double robust_weight(const Station& s, double contrast) const {
    if (ordinary_ <= 0) return 1;
    const double small = contrast / 64;
    const double limit = 4 * (ordinary_ + small * small) * s.pixels;
    double weight = s.square > limit ? std::pow(limit / s.square, 2) : 1;
    if (!judge_) return weight;
    const double bound = 12 * ordinary_ * s.grip + 4 * small * small * s.grip * s.grip;
    if (s.pull * s.pull > 4 * bound) return 0;
    return s.pull * s.pull > bound ? weight / 4 : weight;
  }

  void measure_sector(const Sector& pieces, size_t k) {
    Normal a = Normal::Zero();
    Row b = Row::Zero();
    double square = 0, weight = 0, displaced = 0;
    int segments = 0;
    for (const Piece& piece : pieces) {
      for (int i = 0; i < piece.segments; ++i) {
        const Eigen::Vector2d chord = place(piece, i + 1) - place(piece, i);
        const int axis = std::abs(chord.y()) >= std::abs(chord.x()) ? 1 : 0;
        const double from = place(piece, i)[axis], to = place(piece, i + 1)[axis];
        const Crossing mid = cross(piece, i + 0.5);
        double pull = 0, grip = 0;
        const auto begin = static_cast<int>(std::ceil(std::min(from, to)));
        const auto end = static_cast<int>(std::ceil(std::max(from, to)));
        for (int m = begin; m < end; ++m) {
          const Crossing c = cross(piece, find(piece, axis, m, i));
          const Station s = measure_station(piece, mid, c, axis, m, k);
          if (s.pixels == 0) continue;
          squares_.push_back(s.square / s.pixels);
          const double w = robust_weight(s, contrast_[k]);
          a += w * s.a;
          b += w * s.b;
          pull += w * s.pull;
          grip += w * s.grip;
          square += w * s.square;
          weight += w * s.pixels;
        }
        if (grip > 0) displaced += pull * pull / grip;
        segments += grip > 0;
      }
    }
    double excess = 1;
    if (judge_) excess = std::max(1.0, (displaced / ordinary_ + 8) / (segments + 8));
    square_ += square / excess;
    weight_ += weight / excess;
    const Eigen::Matrix2d levels = a.bottomRightCorner<2, 2>();
    const Eigen::Matrix<double, kUnknowns, 2> shared = a.topRightCorner<kUnknowns, 2>();
    const Eigen::Vector2d change = levels.ldlt().solve(Eigen::Vector2d(b.tail<2>()));
    a_ +=
        (a.topLeftCorner<kUnknowns, kUnknowns>() - shared * levels.inverse() * shared.transpose()) /
        excess;
    b_ += (b.head<kUnknowns>() - shared * change) / excess;
    black_[k] += change[0];
    contrast_[k] += change[1];
  }

  // Where the segment meets a scan line.
  double find(const Piece& piece, int axis, int m, int segment) const {
    double low = segment, high = segment + 1;
    const bool rising = place(piece, high)[axis] > place(piece, low)[axis];
    for (int i = 0; i < 30; ++i) {
      const double s = 0.5 * (low + high);
      ((place(piece, s)[axis] < m) == rising ? low : high) = s;
    }
    return 0.5 * (low + high);
  }

  const TwinInput& in_;
  host::Pose pose_;
  Eigen::Vector3d blur_{1, 0, 1}, offset_{0, 0, 0};
  std::vector<double> black_, contrast_;
  double ordinary_ = 0, square_ = 0, weight_ = 0;
  bool judge_ = false;
  std::vector<double> squares_;
  Eigen::Matrix<double, kUnknowns, kUnknowns> a_;
  Eigen::Matrix<double, kUnknowns, 1> b_;
  Matrix6 covariance_;
};

}  // namespace

TwinResult refine_twin(const TwinInput& input) {
  Twin twin(input);
  for (int i = 0; i < 4; ++i) twin.round(false);
  for (int i = 0; i < 3; ++i) twin.round(true);
  return twin.result();
}

}  // namespace berth::accuracy
