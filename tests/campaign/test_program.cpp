// `berthmark campaign` as it is called: every set, in pieces, with the errors a user may make.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace {

namespace fs = std::filesystem;

class Campaign : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string contents(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// Exit code; what was printed goes to the files stdout and stderr.
  int run(const std::string& arguments) const {
    const std::string line = std::string(BERTHMARK) + " campaign " + arguments + " >" +
                             path("stdout") + " 2>" + path("stderr");
    return WEXITSTATUS(std::system(line.c_str()));
  }

  const fs::path folder_ =
      fs::temp_directory_path() / ("berth_campaign_" + std::to_string(getpid()) + "_" +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Campaign, EnvelopeIsFoundAndNothingElse) {
  EXPECT_EQ(run("--count 24 --check --out " + path("out")), 0) << contents("stdout");
  EXPECT_NE(contents("stdout").find("target identified"), std::string::npos);
  EXPECT_EQ(contents("out/summary.txt"), contents("stdout"));
}

TEST_F(Campaign, InterruptedAndResumedIsTheSame) {
  ASSERT_EQ(run("--set hidden --count 6 --jobs 2 --out " + path("whole")), 0);
  ASSERT_EQ(run("--set hidden --count 3 --jobs 1 --out " + path("parts")), 0);
  // The power fails in the middle of a row.
  fs::resize_file(path("parts/frames.csv"), fs::file_size(path("parts/frames.csv")) - 7);
  ASSERT_EQ(run("--set hidden --count 6 --jobs 1 --out " + path("parts")), 0);
  EXPECT_EQ(contents("whole/frames.csv"), contents("parts/frames.csv"));
  EXPECT_EQ(contents("whole/summary.txt"), contents("parts/summary.txt"));
}

TEST_F(Campaign, AnotherCampaignsFolderIsRefused) {
  ASSERT_EQ(run("--set steep --count 2 --out " + path("out")), 0);
  EXPECT_EQ(run("--set steep --count 2 --seed 1 --out " + path("out")), 2);
  EXPECT_NE(contents("stderr").find("another campaign"), std::string::npos);
}

TEST_F(Campaign, WithoutPhotographsItSaysWhatToInstall) {
  EXPECT_EQ(run("--set empty --count 2 --photos " + path("none")), 2);
  EXPECT_NE(contents("stderr").find("plasma-workspace-wallpapers"), std::string::npos);
}

TEST_F(Campaign, EmptyFramesGiveNothing) {
  cv::Mat photo(900, 1200, CV_8U);
  cv::randu(photo, 0, 255);
  ASSERT_TRUE(cv::imwrite(path("photo.png"), photo));
  EXPECT_EQ(run("--set empty --count 12 --out " + path("out") + " --photos " + folder_.string()),
            0);
  EXPECT_NE(contents("stdout").find("photo"), std::string::npos);
}

TEST_F(Campaign, PicturesOfChosenFrames) {
  EXPECT_EQ(run("--frames 3,5 --pictures " + path("look")), 0);
  EXPECT_TRUE(fs::exists(path("look/envelope_000003.png")));
  EXPECT_TRUE(fs::exists(path("look/envelope_000005_overlay.png")));
  EXPECT_EQ(run("--frames 3"), 2);
}

}  // namespace
