// Natural order of file names: img2.png before img10.png, as people count.
#pragma once

#include <string_view>

namespace berth::host {

/// True where a comes before b: runs of digits compare as numbers, the rest byte by byte; names
/// that are equal so (img01, img1) compare as plain strings, so that the order is total.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace berth::host
