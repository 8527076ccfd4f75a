// Camera files: what is accepted, and one clear line for what is not.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <opencv2/calib3d.hpp>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/default_files.hpp"
#include "tests/render/text_edit.hpp"

namespace berth::host {
namespace {

const std::string kCoefficients = "-0.12, 0.08, 0.0002, -0.0003, 0.";

std::string good() { return default_camera_yaml(); }

void expect_refused(const std::string& text, const std::string& key, const std::string& word,
                    CameraUse use = CameraUse::kHost) {
  const auto camera = parse_camera(text, "cam.yaml", use);
  ASSERT_FALSE(camera) << key;
  const std::string& error = camera.error();
  EXPECT_EQ(error.rfind("cam.yaml: " + key, 0), 0u) << error;
  EXPECT_NE(error.find(word), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

TEST(CameraFile, DefaultIsHec1) {
  const Camera c = default_camera();
  EXPECT_EQ(c.name, "hec1");
  EXPECT_EQ(c.width, 1024);
  EXPECT_EQ(c.height, 1024);
  EXPECT_EQ(c.fx, 1250.0);
  EXPECT_EQ(c.fy, 1250.0);
  EXPECT_EQ(c.cx, 515.3);
  EXPECT_EQ(c.cy, 508.7);
  EXPECT_EQ(c.k1, -0.12);
  EXPECT_EQ(c.k2, 0.08);
  EXPECT_EQ(c.p1, 0.0002);
  EXPECT_EQ(c.p2, -0.0003);
  EXPECT_EQ(c.k3, 0.0);
}

TEST(CameraFile, AcceptsFourFiveAndMoreCoefficientsInRowOrColumn) {
  const std::string four = with(with(good(), kCoefficients, "-0.12, 0.08, 0.0002, -0.0003"),
                                "rows: 1\n   cols: 5", "rows: 4\n   cols: 1");
  ASSERT_TRUE(parse_camera(four, "cam.yaml")) << parse_camera(four, "").error();
  const std::string eight = with(with(good(), kCoefficients, kCoefficients + ", 0., 0., 0."),
                                 "rows: 1\n   cols: 5", "rows: 8\n   cols: 1");
  ASSERT_TRUE(parse_camera(eight, "cam.yaml"));
  EXPECT_EQ(parse_camera(eight, "cam.yaml")->k1, -0.12);
  expect_refused(
      with(with(good(), kCoefficients, kCoefficients + ", 0., 0.1, 0."), "cols: 5", "cols: 8"),
      "distortion_coefficients", "must be zero");
}

TEST(CameraFile, AcceptsFloatMatrices) {
  const std::string text = with(good(), "dt: d", "dt: f");
  ASSERT_TRUE(parse_camera(text, "cam.yaml"));
  EXPECT_NEAR(parse_camera(text, "cam.yaml")->cx, 515.3, 1e-4);
}

TEST(CameraFile, RefusesWhatIsNoYaml) {
  expect_refused("", "is not a readable YAML file", "%YAML");
  expect_refused("hello", "is not a readable YAML file", "%YAML");
  expect_refused("%YAML:1.0\n---\na: [ 1, 2", "is not a readable YAML file", "%YAML");
  expect_refused("%YAML:1.0\n---\n", "is not a readable YAML file", "%YAML");
  expect_refused(std::string("\x89PNG\r\n\x1a\n\0\0", 10), "is not a readable YAML file", "%YAML");
}

TEST(CameraFile, RefusesMissingKeys) {
  expect_refused(without_line(good(), "image_width"), "image_width", "is missing");
  expect_refused(without_line(good(), "image_height"), "image_height", "is missing");
  expect_refused(with(good(), "camera_matrix", "camera_matrx"), "camera_matrix", "is missing");
  expect_refused(with(good(), "distortion_coefficients", "distortion"), "distortion_coefficients",
                 "is missing");
}

TEST(CameraFile, RefusesBadNumbers) {
  expect_refused(with(good(), "1250., 0., 515.3", "-1250., 0., 515.3"), "camera_matrix",
                 "focal lengths must be positive");
  expect_refused(with(good(), "0., 1250., 508.7", "0., 0., 508.7"), "camera_matrix",
                 "focal lengths must be positive");
  expect_refused(with(good(), "1250., 0., 515.3", "1250., 0.5, 515.3"), "camera_matrix", "skew");
  expect_refused(with(good(), "1250., 0., 515.3", ".Nan, 0., 515.3"), "camera_matrix", "finite");
  expect_refused(with(good(), "515.3", "2000."), "camera_matrix", "outside the image");
  expect_refused(with(good(), "0., 0., 1. ]", "0., 0., 2. ]"), "camera_matrix", "the form");
  expect_refused(with(good(), "image_width: 1024", "image_width: -5"), "image_width",
                 "whole number");
  expect_refused(with(good(), "image_width: 1024", "image_width: 640.5"), "image_width",
                 "whole number");
  expect_refused(with(good(), "image_width: 1024", "image_width: wide"), "image_width",
                 "must be a number");
  expect_refused(with(good(), "cols: 5", "cols: 6"), "distortion_coefficients",
                 "must be an !!opencv-matrix");
  expect_refused(with(good(), "plumb_bob", "fisheye"), "distortion_model", "plumb_bob");
}

TEST(CameraFile, RefusesSizesByUse) {
  const std::string large = with(with(with(good(), "image_width: 1024", "image_width: 2048"),
                                      "image_height: 1024", "image_height: 2048"),
                                 "1250., 0., 515.3, 0., 1250.", "2500., 0., 515.3, 0., 2500.");
  EXPECT_TRUE(parse_camera(large, "cam.yaml", CameraUse::kHost));
  expect_refused(large, "image_width", "bin or crop", CameraUse::kFirmware);
  expect_refused(with(good(), "image_height: 1024", "image_height: 9000"), "image_height", "8192");
}

TEST(CameraFile, RefusesDistortionThatFoldsOver) {
  expect_refused(with(good(), kCoefficients, "-1.2, 0., 0., 0., 0."), "distortion_coefficients",
                 "folds over");
  expect_refused(with(good(), kCoefficients, "0., 0., 0., 0., -9."), "distortion_coefficients",
                 "folds over");
  // Strong but monotonic over this image: accepted.
  EXPECT_TRUE(parse_camera(with(good(), kCoefficients, "-0.45, 0.25, 0., 0., 0."), "cam.yaml"));
}

TEST(CameraFile, RefusesFilesThatCannotBeRead) {
  const auto missing = load_camera("/nonexistent/cam.yaml");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().rfind("/nonexistent/cam.yaml: cannot be opened", 0), 0u);
  const auto folder = load_camera(::testing::TempDir());
  ASSERT_FALSE(folder);
  EXPECT_NE(folder.error().find("is a folder"), std::string::npos);
}

TEST(CameraFile, LoadsFromDisk) {
  const std::string path = ::testing::TempDir() + "render_test_camera.yaml";
  std::ofstream(path) << good();
  ASSERT_TRUE(load_camera(path, CameraUse::kFirmware));
}

TEST(CameraModel, ProjectsLikeOpencv) {
  Camera c = default_camera();
  c.k3 = 0.02;
  const cv::Matx33d K(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  const cv::Vec<double, 5> d(c.k1, c.k2, c.p1, c.p2, c.k3);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 500; ++i) {
    points.emplace_back((i % 25 - 12) * 30.0, (i / 25 - 10) * 40.0, 900.0 + 3.0 * (i % 7));
  }
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, d, pixels);
  for (size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d p = project(c, {points[i].x, points[i].y, points[i].z});
    EXPECT_NEAR(p.x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(p.y(), pixels[i].y, 1e-9);
  }
}

TEST(CameraModel, UndistortInvertsTheProjection) {
  const Camera c = default_camera();
  for (int v = 0; v < 1024; v += 31) {
    for (int u = 0; u < 1024; u += 31) {
      const auto ray = undistort(c, Eigen::Vector2d(u, v));
      ASSERT_TRUE(ray);
      const Eigen::Vector2d back = project(c, {ray->x(), ray->y(), 1.0});
      EXPECT_NEAR(back.x(), u, 1e-9);
      EXPECT_NEAR(back.y(), v, 1e-9);
    }
  }
}

// The mean of a bin's pixel centres is the bin's centre.
TEST(CameraModel, BinningKeepsRays) {
  const Camera c = default_camera();
  for (const int factor : {2, 3, 4}) {
    const Camera b = binned(c, factor);
    EXPECT_EQ(b.width, 1024 / factor);
    const Eigen::Vector3d p(37.0, -51.0, 800.0);
    const Eigen::Vector2d full = project(c, p);
    const Eigen::Vector2d small = project(b, p);
    EXPECT_NEAR(small.x() * factor + (factor - 1) / 2.0, full.x(), 1e-9);
    EXPECT_NEAR(small.y() * factor + (factor - 1) / 2.0, full.y(), 1e-9);
  }
}

}  // namespace
}  // namespace berth::host
