// An image file or video frame as the chain takes it: 8 bit, one channel, the camera's size.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace berth::host {

/// What had to be done to an image before the chain could take it; each is said once per run.
struct Conversions {
  bool from_16_bit = false;
  bool from_color = false;
};

/// An image, or (image empty) what is wrong with it.
struct LoadedImage {
  cv::Mat image;
  Conversions conversions;
  std::string error;  // names the cure; without the file's name
};

/// Reads an image file; 16 bit is divided by 257, colour weighted as OpenCV does. A file that
/// breaks off in the middle is an error, not half an image.
LoadedImage load_image(const std::filesystem::path& path);

/// The same for an image already in memory (a video's frame).
LoadedImage to_gray_8(const cv::Mat& raw);

/// Mean of n x n pixels, halves up; rows and columns that do not fill a square are cropped.
/// A binned pixel (i, j) has its centre at (n i + (n - 1) / 2, n j + (n - 1) / 2).
cv::Mat bin_image(const cv::Mat& image, int n);

/// Smallest n for which an image of this size, binned n x n, fits the chain's largest frame.
int binning_for(int width, int height);

}  // namespace berth::host
