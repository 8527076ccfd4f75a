// `berthmark replay` as a user runs it, on rendered frames, a video and large images.
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "program.hpp"

namespace berth::host {
namespace {

/// Rendered frames, the same for all tests here.
const Workplace& rendered() {
  static const Workplace place;
  static const bool done = [] {
    const Outcome render = place.run("render --count 8 --seed 5 --clean --out set");
    EXPECT_EQ(render.exit_code, 0) << render.err;
    return true;
  }();
  EXPECT_TRUE(done);
  return place;
}

std::string column(const std::string& csv, std::size_t row, const std::string& name) {
  const auto lines = lines_of(csv);
  const auto names = fields_of(lines.at(0));
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return fields_of(lines.at(row)).at(i);
  }
  return "no such column";
}

TEST(Replay, FindsTheTargetWhereItWasRendered) {
  const Workplace& place = rendered();
  const Outcome outcome = place.run("replay set --poses poses.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string poses = place.read("poses.csv");
  const std::string truth = place.read("set/truth.csv");
  ASSERT_EQ(lines_of(poses).size(), lines_of(truth).size());
  int valid = 0;
  for (std::size_t row = 1; row < lines_of(poses).size(); ++row) {
    EXPECT_EQ(column(poses, row, "file"), column(truth, row, "file"));
    if (column(poses, row, "valid") != "1") continue;
    ++valid;
    const double z = std::stod(column(truth, row, "tz_mm"));
    EXPECT_NEAR(std::stod(column(poses, row, "tz_mm")), z, 0.01 * z);
  }
  EXPECT_GE(valid, 6);  // of 8 clean frames
}

TEST(Replay, BytesDoNotDependOnJobs) {
  const Workplace& place = rendered();
  ASSERT_EQ(place.run("replay set --poses a.csv --markers am.csv --tum a.txt --jobs 1").exit_code,
            0);
  ASSERT_EQ(place.run("replay set --poses b.csv --markers bm.csv --tum b.txt --jobs 4").exit_code,
            0);
  EXPECT_FALSE(place.read("a.csv").empty());
  EXPECT_EQ(place.read("a.csv"), place.read("b.csv"));
  EXPECT_EQ(place.read("am.csv"), place.read("bm.csv"));
  EXPECT_EQ(place.read("a.txt"), place.read("b.txt"));
}

TEST(Replay, OrderOfImagesDoesNotChangeTheirRows) {
  const Workplace& place = rendered();
  const std::string first = "set/img_000000.png", second = "set/img_000001.png";
  ASSERT_EQ(place.run("replay " + first + " " + second + " --poses a.csv").exit_code, 0);
  ASSERT_EQ(place.run("replay " + second + " " + first + " --poses b.csv").exit_code, 0);
  const auto a = lines_of(place.read("a.csv"));
  const auto b = lines_of(place.read("b.csv"));
  ASSERT_EQ(a.size(), 3u);
  EXPECT_EQ(a[1], b.at(2));
  EXPECT_EQ(a[2], b.at(1));
  EXPECT_EQ(fields_of(a[1]).at(0), first);  // as given on the command line
}

TEST(Replay, TrackingAgreesWithSingleImagesAndDoesNotDependOnJobs) {
  const Workplace& place = rendered();
  ASSERT_EQ(place.run("replay set --poses single.csv").exit_code, 0);
  ASSERT_EQ(place.run("replay set --track --jobs 4 --poses a.csv").exit_code, 0);
  ASSERT_EQ(place.run("replay set --track --jobs 1 --poses b.csv").exit_code, 0);
  EXPECT_EQ(place.read("a.csv"), place.read("b.csv"));
  const auto single = lines_of(place.read("single.csv")), tracked = lines_of(place.read("a.csv"));
  ASSERT_EQ(single.size(), tracked.size());
  for (std::size_t i = 1; i < single.size(); ++i) {
    EXPECT_EQ(fields_of(single[i]).at(1), fields_of(tracked[i]).at(1)) << single[i];  // valid
  }
}

TEST(Replay, PosesGoToStandardOutputWithoutOtherOutputs) {
  const Outcome outcome = rendered().run("replay set/img_000000.png");
  EXPECT_EQ(lines_of(outcome.out).size(), 2u);
}

TEST(Replay, SummaryJudgesByTheTruthBesideTheImages) {
  const Outcome outcome = rendered().run("replay set --summary");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("target identified"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("false poses"), std::string::npos) << outcome.out;
}

TEST(Replay, OverlayAndReportAreWritten) {
  const Workplace& place = rendered();
  const Outcome outcome = place.run("replay set --overlay drawn --report report.html");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (int i = 0; i < 8; ++i) {
    const std::string name = "drawn/img_00000" + std::to_string(i) + ".png";
    const cv::Mat picture = cv::imread(place.path(name).string(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.size(), cv::Size(1024, 1024)) << name;
    EXPECT_EQ(picture.channels(), 3) << name;
  }
  const std::string html = place.read("report.html");
  EXPECT_NE(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find("data:image/jpeg;base64,"), std::string::npos);
  EXPECT_EQ(html.find("src=\"http"), std::string::npos);
  for (const char* bad : {">nan", "\"nan", " nan", ">inf", "\"inf"}) {
    EXPECT_EQ(html.find(bad), std::string::npos) << bad;
  }
}

TEST(Replay, ReferenceAddsColumnsAtTheEnd) {
  const Workplace& place = rendered();
  const Outcome outcome = place.run("replay set/img_000000.png --reference --poses ref.csv");
  EXPECT_NE(outcome.exit_code, 2) << outcome.err;
  const auto lines = lines_of(place.read("ref.csv"));
  EXPECT_EQ(fields_of(lines.at(0)).at(27), "ref_tx_mm");
  EXPECT_EQ(fields_of(lines.at(0)).size(), fields_of(lines.at(1)).size());
}

TEST(Replay, TargetFreeFramesHaveNoValidPose) {
  const Workplace place;
  ASSERT_EQ(place.run("render --count 4 --seed 9 --no-target --out none").exit_code, 0);
  const Outcome outcome = place.run("replay none --poses out.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (std::size_t row = 1; row <= 4; ++row) {
    EXPECT_EQ(column(place.read("out.csv"), row, "valid"), "0");
  }
}

TEST(Replay, VideoFramesAreNumbered) {
  const Workplace place;
  cv::VideoWriter video(place.path("v.avi").string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                        8, {1024, 1024}, false);
  if (!video.isOpened()) GTEST_SKIP() << "OpenCV has no MJPG writer here";
  for (int i = 0; i < 3; ++i) video.write(cv::Mat(1024, 1024, CV_8UC1, cv::Scalar(40 * i)));
  video.release();
  const Outcome outcome = place.run("replay v.avi --poses out.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string csv = place.read("out.csv");
  ASSERT_EQ(lines_of(csv).size(), 4u);
  EXPECT_EQ(column(csv, 1, "file"), "v.avi#0");
  EXPECT_EQ(column(csv, 3, "file"), "v.avi#2");
}

// A camera of 2048 x 2048 is binned 2 x 2: HEC-1's image enlarged twice must give the same pose.
TEST(Replay, LargeImagesAreBinnedWithTheirCamera) {
  const Workplace& place = rendered();
  const cv::Mat image = cv::imread(place.path("set/img_000000.png").string(), cv::IMREAD_GRAYSCALE);
  cv::Mat large;
  cv::resize(image, large, {}, 2, 2, cv::INTER_NEAREST);
  cv::imwrite(place.path("large.png").string(), large);
  place.write("large.yaml", R"(%YAML:1.0
---
image_width: 2048
image_height: 2048
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 2500., 0., 1031.1, 0., 2500., 1017.9, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.12, 0.08, 0.0002, -0.0003, 0. ]
)");
  const Outcome outcome = place.run("replay large.png --camera large.yaml --poses large.csv");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("binned 2 x 2"), std::string::npos) << outcome.err;
  ASSERT_EQ(place.run("replay set/img_000000.png --poses small.csv").exit_code, 0);
  const auto large_row = fields_of(lines_of(place.read("large.csv")).at(1));
  const auto small_row = fields_of(lines_of(place.read("small.csv")).at(1));
  EXPECT_EQ(std::vector<std::string>(large_row.begin() + 1, large_row.end()),
            std::vector<std::string>(small_row.begin() + 1, small_row.end()));
}

// In the foreground: otherwise timeout signals the program and then its group, which is Ctrl-C
// twice.
TEST(Replay, InterruptWritesWhatIsDone) {
  const Workplace& place = rendered();
  std::string many;
  for (int i = 0; i < 2000; ++i) many += " set/img_000000.png";
  const Outcome outcome = place.run("replay" + many + " --poses cut.csv --jobs 1",
                                    "timeout --foreground --signal=INT 5");
  if (outcome.exit_code == 0) GTEST_SKIP() << "too fast to be interrupted";
  EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
  const auto lines = lines_of(place.read("cut.csv"));
  ASSERT_GE(lines.size(), 1u);
  for (const std::string& line : lines) EXPECT_EQ(fields_of(line).size(), 27u);
}

TEST(Replay, EverySubCommandHasHelp) {
  for (const char* command : {"--help", "replay --help", "render --help"}) {
    const Outcome outcome = rendered().run(command);
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_NE(outcome.out.find("Usage"), std::string::npos) << command;
  }
}

}  // namespace
}  // namespace berth::host
