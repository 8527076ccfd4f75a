// `berthmark render` as a user calls it: files, truth, and what it refuses.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "host_sim/render/render.hpp"
#include "host_sim/render/render_command.hpp"
#include "host_sim/render/sample_scene.hpp"
#include "host_sim/render/truth_csv.hpp"

namespace berth::host {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string error;
};

Outcome run(std::vector<std::string> arguments) {
  Outcome outcome;
  CLI::App app("test");
  add_render_command(app, outcome.exit_code);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes the last one first
  arguments.push_back("render");
  ::testing::internal::CaptureStderr();
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    outcome.exit_code = 2;
  }
  outcome.error = ::testing::internal::GetCapturedStderr();
  return outcome;
}

std::string fresh_folder(const std::string& name) {
  const std::string folder = ::testing::TempDir() + "berth_render_" + name;
  fs::remove_all(folder);
  return folder;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::vector<std::string>> table_of(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

TEST(RenderCommand, WritesFramesAndTruth) {
  const std::string out = fresh_folder("basic");
  ASSERT_EQ(run({"--count", "3", "--seed", "4", "--out", out}).exit_code, 0);
  const auto rows = table_of(out + "/truth.csv");
  ASSERT_EQ(rows.size(), 4u);
  const std::string header = truth_header();
  EXPECT_EQ(header.rfind("file,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,", 0), 0u);
  SceneOptions options;
  options.seed = 4;
  const Camera camera = default_camera();
  for (uint64_t i = 0; i < 3; ++i) {
    const Scene scene = sample_scene(options, i, camera, default_target());
    const auto& row = rows[i + 1];
    ASSERT_EQ(row.size(), rows[0].size());
    EXPECT_EQ(row[0], "img_00000" + std::to_string(i) + ".png");
    EXPECT_NEAR(std::stod(row[3]), scene.pose.t.z(), 1e-9);
    const cv::Mat image = cv::imread(out + "/" + row[0], cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_8UC1);
    const Image8 frame = render_frame(scene, camera, default_target());
    EXPECT_TRUE(std::equal(frame.data.begin(), frame.data.end(), image.begin<uchar>()));
  }
}

TEST(RenderCommand, JobsDoNotChangeAByte) {
  const std::string one = fresh_folder("one");
  const std::string many = fresh_folder("many");
  ASSERT_EQ(run({"--count", "5", "--seed", "8", "--out", one, "--jobs", "1"}).exit_code, 0);
  ASSERT_EQ(run({"--count", "5", "--seed", "8", "--out", many, "--jobs", "4"}).exit_code, 0);
  for (const auto& entry : fs::directory_iterator(one)) {
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(many + "/" + entry.path().filename().string()));
  }
}

TEST(RenderCommand, NoTargetLeavesThePoseEmpty) {
  const std::string out = fresh_folder("none");
  ASSERT_EQ(run({"--count", "1", "--out", out, "--no-target"}).exit_code, 0);
  const auto rows = table_of(out + "/truth.csv");
  for (size_t i = 1; i <= 7; ++i) EXPECT_EQ(rows[1][i], "");
  EXPECT_NE(rows[1][8], "");  // the scene's parameters stay
}

TEST(RenderCommand, FixedDistanceAndTilt) {
  const std::string out = fresh_folder("fixed");
  ASSERT_EQ(
      run({"--count", "2", "--out", out, "--clean", "--distance", "777", "--tilt", "12"}).exit_code,
      0);
  for (const auto& row : table_of(out + "/truth.csv")) {
    if (row[0] == "file") continue;
    EXPECT_EQ(row[8], "777.000000");
    EXPECT_EQ(row[9], "12.000000");
  }
}

void expect_refused(const std::vector<std::string>& arguments, const std::string& word) {
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.error.find(word), std::string::npos) << outcome.error;
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
}

TEST(RenderCommand, RefusesWithOneLine) {
  const std::string blocked = fresh_folder("blocked");
  std::ofstream(blocked) << "a file where a folder should be";
  expect_refused({"--count", "1", "--out", blocked}, "cannot be written");
  const std::string out = fresh_folder("refused");
  expect_refused({"--count", "1", "--out", out, "--camera", "/nonexistent.yaml"},
                 "/nonexistent.yaml: cannot be opened");
  expect_refused({"--count", "1", "--out", out, "--target", blocked}, "not a readable YAML");
  expect_refused({"--count", "1", "--out", out, "--distance", "100"}, "does not fit");
  EXPECT_EQ(run({"--count", "0", "--out", out}).exit_code, 2);
  EXPECT_EQ(run({"--out", out}).exit_code, 2);
}

TEST(TruthCsv, QuaternionIsThatOfTheRotation) {
  SceneOptions options;
  for (uint64_t i = 0; i < 200; ++i) {
    const Scene scene = sample_scene(options, i, default_camera(), default_target());
    const auto q = quaternion_from_rotation(scene.pose.R);
    EXPECT_GE(q[0], 0.0);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    Eigen::Matrix3d R;
    R << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    EXPECT_NEAR((R - scene.pose.R).norm(), 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace berth::host
