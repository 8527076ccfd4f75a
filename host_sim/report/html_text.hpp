// Pieces of HTML: escaped text, pictures as data, tables.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace berth::host {

/// Text with & < > " as entities.
std::string escape_html(const std::string& text);

/// RFC 4648 base64 with padding.
std::string base64(const std::vector<std::uint8_t>& bytes);

/// A picture as a JPEG data URL, scaled down to at most `width` pixels.
std::string jpeg_url(const cv::Mat& picture, int width);

/// A table; the first column is text, the others are set right. Cells are HTML.
std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows);

}  // namespace berth::host
