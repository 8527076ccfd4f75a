// Whether an image file is whole, before a decoder sees it: libpng prints complaints of its own,
// and libjpeg fills what is missing with grey.
#pragma once

#include <cstdint>
#include <vector>

namespace berth::host {

enum class Integrity { kWhole, kTruncated, kDamaged };

/// PNG: chunks up to IEND with right CRCs. JPEG: an end-of-image marker near the end. Other formats
/// are taken for whole. Cost: about 2 ms for a megapixel.
Integrity check_integrity(const std::vector<std::uint8_t>& bytes);

}  // namespace berth::host
