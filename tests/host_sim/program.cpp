#include "program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

namespace berth::host {

namespace fs = std::filesystem;

int Outcome::error_lines() const {
  return static_cast<int>(std::count(err.begin(), err.end(), '\n'));
}

Workplace::Workplace() {
  std::string name = (fs::temp_directory_path() / "berthmark_test_XXXXXX").string();
  folder_ = mkdtemp(name.data());
}

Workplace::~Workplace() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

Outcome Workplace::run(const std::string& arguments, const std::string& environment) const {
  const std::string command = "cd '" + folder_.string() + "' && " + environment +
                              " " BERTH_PROGRAM " " + arguments + " > .stdout 2> .stderr";
  const int status = std::system(command.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  outcome.out = read(".stdout");
  outcome.err = read(".stderr");
  return outcome;
}

void Workplace::write(const std::string& name, const std::string& text) const {
  fs::create_directories(path(name).parent_path());
  std::ofstream(path(name), std::ios::binary) << text;
}

std::string Workplace::read(const std::string& name) const {
  std::ifstream file(path(name), std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void Workplace::write_image(const std::string& name, cv::Size size, int type) const {
  fs::create_directories(path(name).parent_path());
  cv::Mat image(size, type, cv::Scalar::all(CV_MAT_DEPTH(type) == CV_16U ? 20000 : 90));
  cv::imwrite(path(name).string(), image);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

}  // namespace berth::host
