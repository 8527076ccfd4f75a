#include "host_sim/report/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

constexpr int kFractionBits = 4;  // of OpenCV's drawing coordinates
constexpr double kFontScale = 0.42;
constexpr int kLineHeight = 17;
constexpr int kMargin = 7;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

}  // namespace

Canvas::Canvas(const cv::Mat& gray) : origin_(0, 0) {
  cv::cvtColor(gray, picture_, cv::COLOR_GRAY2BGR);
}

Canvas::Canvas(const cv::Mat& gray, cv::Point2d center, double scale, int side)
    : origin_(center - cv::Point2d(side, side) * (0.5 / scale)), scale_(scale) {
  const cv::Matx23d image_from_screen(1 / scale, 0, origin_.x, 0, 1 / scale, origin_.y);
  cv::Mat window;
  cv::warpAffine(gray, window, image_from_screen, {side, side},
                 cv::INTER_NEAREST | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT, 40);
  cv::cvtColor(window, picture_, cv::COLOR_GRAY2BGR);
}

cv::Point Canvas::to_screen(cv::Point2d p) const {
  // Far outside, OpenCV's fixed-point coordinates would overflow.
  constexpr double kFar = 16000;
  const cv::Point2d s = (p - origin_) * scale_;
  return {cvRound(std::clamp(s.x, -kFar, kFar) * (1 << kFractionBits)),
          cvRound(std::clamp(s.y, -kFar, kFar) * (1 << kFractionBits))};
}

void Canvas::line(cv::Point2d a, cv::Point2d b, const cv::Scalar& color, int thickness) {
  cv::line(picture_, to_screen(a), to_screen(b), color, thickness, cv::LINE_AA, kFractionBits);
}

void Canvas::polyline(const std::vector<cv::Point2d>& points, bool closed, const cv::Scalar& color,
                      int thickness) {
  std::vector<cv::Point> screen;
  for (const cv::Point2d& p : points) screen.push_back(to_screen(p));
  cv::polylines(picture_, screen, closed, color, thickness, cv::LINE_AA, kFractionBits);
}

void Canvas::arrow(cv::Point2d a, cv::Point2d b, const cv::Scalar& color) {
  line(a, b, color, 2);
  const cv::Point2d d = b - a;
  const double length = std::hypot(d.x, d.y);
  if (length * scale_ < 12) return;
  const cv::Point2d back = d * (-8 / (scale_ * length));
  const cv::Point2d side(-back.y * 0.45, back.x * 0.45);
  line(b, b + back + side, color, 2);
  line(b, b + back - side, color, 2);
}

void Canvas::cross(cv::Point2d center, double arm_screen_px, const cv::Scalar& color) {
  const double arm = arm_screen_px / scale_;
  line(center - cv::Point2d(arm, 0), center + cv::Point2d(arm, 0), color);
  line(center - cv::Point2d(0, arm), center + cv::Point2d(0, arm), color);
}

void Canvas::label(const std::string& text, cv::Point2d center, cv::Point2d offset,
                   const cv::Scalar& color) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kFontScale, 1, &baseline);
  const cv::Point2d at = (center - origin_) * scale_ + offset;
  const cv::Point corner(cvRound(at.x) - size.width / 2, cvRound(at.y) + size.height / 2);
  cv::putText(picture_, text, corner, kFont, kFontScale, cv::Scalar::all(0), 3, cv::LINE_AA);
  cv::putText(picture_, text, corner, kFont, kFontScale, color, 1, cv::LINE_AA);
}

cv::Size text_box_size(const std::vector<std::string>& lines) {
  int width = 0;
  for (const std::string& line : lines) {
    int baseline = 0;
    width = std::max(width, cv::getTextSize(line, kFont, kFontScale, 1, &baseline).width);
  }
  return {width + 2 * kMargin, static_cast<int>(lines.size()) * kLineHeight + 2 * kMargin};
}

void draw_text_box(cv::Mat& picture, cv::Point corner, const std::vector<std::string>& lines) {
  const cv::Rect box = cv::Rect(corner, text_box_size(lines)) & cv::Rect({0, 0}, picture.size());
  cv::Mat under = picture(box);
  under.convertTo(under, -1, 0.25);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const cv::Point at(corner.x + kMargin,
                       corner.y + kMargin + kLineHeight * static_cast<int>(i) + 12);
    cv::putText(picture, lines[i], at, kFont, kFontScale, colors::kWhite, 1, cv::LINE_AA);
  }
}

}  // namespace berth::host
