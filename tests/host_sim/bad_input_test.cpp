// Bad input: one clear line each that names the file and the cure, and the right exit code.
#include <gtest/gtest.h>

#include "program.hpp"

namespace berth::host {
namespace {

constexpr int kWrongUsage = 2;

/// One line on standard error with these words in it.
void expect_line(const Outcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  for (const std::string& word : words) {
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " not in: " << outcome.err;
  }
}

void expect_refused(const Outcome& outcome, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.exit_code, kWrongUsage) << outcome.err;
  expect_line(outcome, words);
}

TEST(BadInput, FileThatIsNoImage) {
  const Workplace place;
  place.write("notes.txt", "not a picture");
  expect_refused(place.run("replay notes.txt --poses out.csv"), {"notes.txt", "PNG"});
  EXPECT_EQ(fields_of(lines_of(place.read("out.csv")).at(1)).at(2), "bad_frame");
}

TEST(BadInput, MissingFile) {
  const Workplace place;
  expect_refused(place.run("replay nowhere.png"), {"nowhere.png", "check the path"});
}

TEST(BadInput, EmptyFolder) {
  const Workplace place;
  std::filesystem::create_directory(place.path("empty"));
  expect_refused(place.run("replay empty"), {"empty", "PNG"});
}

TEST(BadInput, EmptyFile) {
  const Workplace place;
  place.write("a.png", "");
  expect_refused(place.run("replay a.png"), {"a.png", "empty"});
}

TEST(BadInput, TruncatedPng) {
  const Workplace place;
  place.write_image("a.png");
  const std::string bytes = place.read("a.png");
  place.write("a.png", bytes.substr(0, bytes.size() / 2));
  expect_refused(place.run("replay a.png"), {"a.png", "breaks off", "copy it again"});
}

TEST(BadInput, DamagedPng) {
  const Workplace place;
  place.write_image("a.png");
  std::string bytes = place.read("a.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  place.write("a.png", bytes);
  expect_refused(place.run("replay a.png"), {"a.png", "damaged", "copy it again"});
}

TEST(BadInput, TruncatedJpeg) {
  const Workplace place;
  place.write_image("a.jpg");
  const std::string bytes = place.read("a.jpg");
  place.write("a.jpg", bytes.substr(0, bytes.size() / 2));
  expect_refused(place.run("replay a.jpg"), {"a.jpg", "breaks off"});
}

TEST(BadInput, BadImageAmongGoodOnesCostsItsOwnRow) {
  const Workplace place;
  place.write_image("set/img1.png");
  place.write("set/img2.png", "rubbish");
  place.write_image("set/img10.png");
  const Outcome outcome = place.run("replay set --poses out.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_line(outcome, {"img2.png"});
  const auto rows = lines_of(place.read("out.csv"));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(fields_of(rows[1]).at(0), "img1.png");
  EXPECT_EQ(fields_of(rows[2]).at(2), "bad_frame");
  EXPECT_EQ(fields_of(rows[3]).at(0), "img10.png");
  EXPECT_NE(fields_of(rows[3]).at(2), "bad_frame");
}

TEST(BadInput, ImageOfAnotherSize) {
  const Workplace place;
  place.write_image("a.png", {640, 480});
  expect_refused(place.run("replay a.png --poses out.csv"), {"a.png", "640 x 480", "--camera"});
  EXPECT_EQ(fields_of(lines_of(place.read("out.csv")).at(1)).at(2), "bad_frame");
}

TEST(BadInput, LargeImageOfSmallCamera) {
  const Workplace place;
  place.write_image("a.png", {2048, 2048});
  expect_refused(place.run("replay a.png"), {"a.png", "2048 x 2048"});
}

TEST(BadInput, SixteenBitAndColorAreConvertedAndSaidOnce) {
  const Workplace place;
  place.write_image("set/a.png", {1024, 1024}, CV_16UC1);
  place.write_image("set/b.png", {1024, 1024}, CV_16UC1);
  place.write_image("set/c.png", {1024, 1024}, CV_8UC3);
  place.write_image("set/d.png", {1024, 1024}, CV_8UC3);
  const Outcome outcome = place.run("replay set --poses out.csv --jobs 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.error_lines(), 2) << outcome.err;
  EXPECT_NE(outcome.err.find("a.png: 16-bit"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("c.png: colour"), std::string::npos) << outcome.err;
}

constexpr const char* kCamera = R"(%YAML:1.0
---
image_width: 1024
image_height: 1024
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ FOCAL, 0., 512., 0., 1250., 512., 0., 0., 1. ]
)";

std::string camera_with(const std::string& focal, const std::string& rest) {
  std::string text = kCamera;
  return text.replace(text.find("FOCAL"), 5, focal) + rest;
}

constexpr const char* kNoDistortion = R"(distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0., 0., 0., 0., 0. ]
)";

TEST(BadInput, CameraWithMissingKey) {
  const Workplace place;
  place.write_image("a.png");
  place.write("cam.yaml", camera_with("1250.", ""));
  expect_refused(place.run("replay a.png --camera cam.yaml"),
                 {"cam.yaml", "distortion_coefficients"});
}

TEST(BadInput, CameraWithNegativeFocalLength) {
  const Workplace place;
  place.write_image("a.png");
  place.write("cam.yaml", camera_with("-1250.", kNoDistortion));
  expect_refused(place.run("replay a.png --camera cam.yaml"), {"cam.yaml", "positive"});
}

TEST(BadInput, CameraThatIsNoYaml) {
  const Workplace place;
  place.write_image("a.png");
  place.write("cam.yaml", "width = 1024\n");
  expect_refused(place.run("replay a.png --camera cam.yaml"), {"cam.yaml"});
}

TEST(BadInput, TargetWithMissingKey) {
  const Workplace place;
  place.write_image("a.png");
  place.write("target.yaml", "%YAML:1.0\n---\nname: half\nplate_size_mm: [ 120., 120. ]\n");
  expect_refused(place.run("replay a.png --target target.yaml"), {"target.yaml"});
}

TEST(BadInput, MountThatDoesNotExist) {
  const Workplace place;
  place.write_image("a.png");
  expect_refused(place.run("replay a.png --mount nowhere.yaml"), {"nowhere.yaml"});
}

TEST(BadInput, TruthOfAnotherKind) {
  const Workplace place;
  place.write_image("a.png");
  place.write("truth.csv", "name,value\n1,2\n");
  expect_refused(place.run("replay a.png"), {"truth.csv", "file", "render"});
}

// Tests may run as root, to whom every folder is writable: nothing can lie below a file, though.
TEST(BadInput, OutputsThatCannotBeWritten) {
  const Workplace place;
  place.write_image("a.png");
  place.write("file", "in the way");
  for (const std::string option : {"--poses", "--markers", "--tum", "--report", "--overlay"}) {
    expect_refused(place.run("replay a.png " + option + " file/out"),
                   {"file/out", "cannot be written", "writable"});
  }
}

TEST(BadInput, OnTargetWithoutQemu) {
  const Workplace place;
  place.write_image("a.png");
  place.write("image.elf", "stands for the firmware");
  expect_refused(place.run("replay a.png --on-target --firmware image.elf", "PATH=/nowhere"),
                 {"qemu-system-arm", "apt-get install"});
}

TEST(BadInput, OnTargetWithoutFirmware) {
  const Workplace place;
  place.write_image("a.png");
  expect_refused(place.run("replay a.png --on-target --firmware nowhere.elf"), {"nowhere.elf"});
}

TEST(BadInput, UnknownOption) {
  const Workplace place;
  expect_refused(place.run("replay a.png --colour"), {"--colour", "--help"});
}

TEST(BadInput, NoSubCommand) {
  const Workplace place;
  expect_refused(place.run(""), {"--help"});
}

TEST(BadInput, NoPath) {
  const Workplace place;
  expect_refused(place.run("replay"), {"PATH", "--help"});
}

TEST(BadInput, NoJobs) {
  const Workplace place;
  place.write_image("a.png");
  expect_refused(place.run("replay a.png --jobs 0"), {"--jobs"});
}

}  // namespace
}  // namespace berth::host
