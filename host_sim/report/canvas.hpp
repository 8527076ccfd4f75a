// A picture to draw on in image coordinates, at any magnification: thin anti-aliased lines.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace berth::host {

namespace colors {  // blue, green, red
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kRed(70, 70, 255);
const cv::Scalar kGreen(90, 230, 90);
const cv::Scalar kBlue(255, 140, 60);
const cv::Scalar kYellow(60, 220, 255);
const cv::Scalar kMagenta(255, 90, 255);
const cv::Scalar kCyan(255, 230, 60);
}  // namespace colors

/// A window of an image, shown at `scale` screen pixels per image pixel. Image coordinates have
/// the centre of the top-left pixel at (0, 0), magnified pictures as well.
class Canvas {
 public:
  /// The whole image, one to one; 8-bit grey.
  explicit Canvas(const cv::Mat& gray);
  /// The window of `gray` around `center` that fills side x side screen pixels.
  Canvas(const cv::Mat& gray, cv::Point2d center, double scale, int side);

  void line(cv::Point2d a, cv::Point2d b, const cv::Scalar& color, int thickness = 1);
  void polyline(const std::vector<cv::Point2d>& points, bool closed, const cv::Scalar& color,
                int thickness = 1);
  void arrow(cv::Point2d a, cv::Point2d b, const cv::Scalar& color);
  void cross(cv::Point2d center, double arm_screen_px, const cv::Scalar& color);
  /// Text with its middle at `center`, moved by `offset` screen pixels; outlined, to be read on
  /// black and on white.
  void label(const std::string& text, cv::Point2d center, cv::Point2d offset,
             const cv::Scalar& color);

  cv::Mat& picture() { return picture_; }
  double scale() const { return scale_; }

 private:
  cv::Point to_screen(cv::Point2d p) const;

  cv::Mat picture_;
  cv::Point2d origin_;  // image coordinates of the picture's top-left pixel's centre
  double scale_ = 1;
};

/// Lines of text on a translucent box with its top-left corner at `corner`.
void draw_text_box(cv::Mat& picture, cv::Point corner, const std::vector<std::string>& lines);
/// Size of that box.
cv::Size text_box_size(const std::vector<std::string>& lines);

}  // namespace berth::host
