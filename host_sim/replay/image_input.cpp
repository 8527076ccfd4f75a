#include "host_sim/replay/image_input.hpp"

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "host_sim/replay/file_integrity.hpp"
#include "image/view.hpp"

namespace berth::host {
namespace {

constexpr const char* kNotAnImage = "not an image that OpenCV reads; give PNG, PGM, JPEG or TIFF";
constexpr const char* kTruncated = "the file breaks off before the image ends; copy it again";
constexpr const char* kDamaged = "the file is damaged (checksum); copy it again";

using Bytes = std::vector<std::uint8_t>;

LoadedImage failed(std::string error) {
  LoadedImage out;
  out.error = std::move(error);
  return out;
}

}  // namespace

LoadedImage load_image(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return failed("cannot be opened; check the name and the permissions");
  std::error_code unknown;
  Bytes bytes(std::filesystem::is_regular_file(path, unknown) ? std::filesystem::file_size(path)
                                                              : 0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  if (bytes.empty()) return failed("the file is empty; copy it again");
  const Integrity integrity = check_integrity(bytes);
  if (integrity == Integrity::kTruncated) return failed(kTruncated);
  if (integrity == Integrity::kDamaged) return failed(kDamaged);
  cv::Mat raw;
  try {
    raw = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    // Absurd sizes in a header end here; the file is no more an image than any other rubbish.
  }
  return raw.empty() ? failed(kNotAnImage) : to_gray_8(raw);
}

LoadedImage to_gray_8(const cv::Mat& raw) {
  LoadedImage out;
  if (raw.depth() != CV_8U && raw.depth() != CV_16U) {
    return failed("its pixels are neither 8 nor 16 bit; convert it to 8-bit grey");
  }
  cv::Mat gray;
  switch (raw.channels()) {
    case 1:
      gray = raw;
      break;
    case 3:
      cv::cvtColor(raw, gray, cv::COLOR_BGR2GRAY);
      break;
    case 4:
      cv::cvtColor(raw, gray, cv::COLOR_BGRA2GRAY);
      break;
    default:
      return failed("it has neither 1, 3 nor 4 channels; convert it to 8-bit grey");
  }
  out.conversions.from_color = raw.channels() != 1;
  out.conversions.from_16_bit = raw.depth() == CV_16U;
  if (out.conversions.from_16_bit) gray.convertTo(gray, CV_8U, 1.0 / 257.0);
  out.image = gray.isContinuous() ? gray : gray.clone();
  return out;
}

cv::Mat bin_image(const cv::Mat& image, int n) {
  cv::Mat out(image.rows / n, image.cols / n, CV_8UC1);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      int sum = 0;
      for (int j = 0; j < n; ++j) {
        const std::uint8_t* row = image.ptr<std::uint8_t>(y * n + j) + x * n;
        for (int i = 0; i < n; ++i) sum += row[i];
      }
      out.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((sum + n * n / 2) / (n * n));
    }
  }
  return out;
}

int binning_for(int width, int height) {
  int n = 1;
  while (width / n > kMaxImageSide || height / n > kMaxImageSide) ++n;
  return n;
}

}  // namespace berth::host
