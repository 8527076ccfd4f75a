#include "host_sim/reference/blobs.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace berth::host {
namespace {

constexpr int kBlockSizes_px[] = {25, 51, 101, 201};
constexpr double kAboveMean_dn[] = {3, 8};
constexpr double kSmoothing_px = 1.5;
constexpr double kMinSemiAxis_px = 2.0;
constexpr double kMinAxisRatio = 0.4;

double rms_misfit(const std::vector<cv::Point>& contour, const cv::RotatedRect& e) {
  const double angle = e.angle * CV_PI / 180;
  const double a = e.size.width / 2;
  const double b = e.size.height / 2;
  double sum = 0;
  for (const cv::Point& p : contour) {
    const double dx = p.x - double{e.center.x};
    const double dy = p.y - double{e.center.y};
    const double u = (dx * std::cos(angle) + dy * std::sin(angle)) / a;
    const double v = (dy * std::cos(angle) - dx * std::sin(angle)) / b;
    const double radial = std::hypot(u, v);
    // First-order distance: the level's excess over its gradient.
    const double slope = std::hypot(u / a, v / b) / std::max(radial, 1e-9);
    sum += std::pow((radial - 1) / std::max(slope, 1e-9), 2);
  }
  return std::sqrt(sum / static_cast<double>(contour.size()));
}

void add_contour(const std::vector<cv::Point>& contour, std::vector<Blob>& blobs) {
  if (contour.size() < 10) return;
  Blob blob;
  blob.ellipse = cv::fitEllipse(contour);
  const double major = blob.semi_major_px();
  const double minor = blob.semi_minor_px();
  if (!(minor >= kMinSemiAxis_px) || !(minor >= kMinAxisRatio * major) || major > 2000) return;
  blob.misfit_px = rms_misfit(contour, blob.ellipse);
  if (blob.misfit_px > std::max(0.7, 0.05 * minor)) return;
  blobs.push_back(blob);
}

bool is_same(const Blob& a, const Blob& b) {
  const double tolerance = std::max(1.5, 0.08 * a.semi_minor_px());
  return cv::norm(a.center() - b.center()) < tolerance &&
         std::abs(a.semi_major_px() - b.semi_major_px()) < 2 * tolerance;
}

std::vector<Blob> without_repetition(std::vector<Blob> blobs) {
  const auto relative = [](const Blob& b) { return b.misfit_px / b.semi_minor_px(); };
  std::stable_sort(blobs.begin(), blobs.end(),
                   [&](const Blob& a, const Blob& b) { return relative(a) < relative(b); });
  std::vector<Blob> kept;
  for (const Blob& blob : blobs) {
    const auto same = [&](const Blob& other) { return is_same(blob, other); };
    if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(blob);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const Blob& a, const Blob& b) {
    return a.semi_major_px() > b.semi_major_px();
  });
  return kept;
}

}  // namespace

std::vector<Blob> find_blobs(const cv::Mat& gray) {
  cv::Mat smooth;
  cv::GaussianBlur(gray, smooth, cv::Size(), kSmoothing_px);
  std::vector<Blob> blobs;
  for (const int block : kBlockSizes_px) {
    for (const double above : kAboveMean_dn) {
      cv::Mat bright;
      cv::adaptiveThreshold(smooth, bright, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY,
                            block, -above);
      std::vector<std::vector<cv::Point>> contours;
      cv::findContours(bright, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
      for (const auto& contour : contours) add_contour(contour, blobs);
    }
  }
  return without_repetition(std::move(blobs));
}

}  // namespace berth::host
