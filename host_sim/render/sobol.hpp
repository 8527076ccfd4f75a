// A low-discrepancy sequence: Sobol points with Owen's nested uniform scrambling.
//
// Every prefix of the sequence is a valid sample, each point alone is uniform, and point i does not
// depend on how many are drawn. Direction numbers: Joe and Kuo (2008); scrambling: Owen (1995), the
// random bits from a hash of the seed, the dimension and the digits before.
#pragma once

#include <cstdint>

namespace berth::host {

inline constexpr int kSobolDimensions = 21;

/// What each dimension draws; the earlier ones are the more evenly spread.
enum class Dimension {
  kDistance,
  kTilt,
  kPositionX,
  kPositionY,
  kTiltDirection,
  kRoll,
  kWhite,
  kBlack,
  kNoise,
  kDefocus,
  kMotion,
  kMotionDirection,
  kBackground,
  kOcclusion,
  kShadow,
  kGlint,
  kGradient,
  kGradientRatio,
  kSaturation,
  kShadowDepth,
  kGradientDirection,
};

/// Coordinate `dimension` of point `index`, in (0, 1).
double scrambled_sobol(uint64_t seed, uint32_t index, int dimension);

/// One point of the sequence, its coordinates by name.
class SobolPoint {
 public:
  SobolPoint(uint64_t seed, uint64_t index) : seed_(seed), index_(static_cast<uint32_t>(index)) {}
  double operator[](Dimension dimension) const {
    return scrambled_sobol(seed_, index_, static_cast<int>(dimension));
  }

 private:
  uint64_t seed_;
  uint32_t index_;
};

/// The coordinate before scrambling, as a binary fraction of 32 bits.
uint32_t sobol_bits(uint32_t index, int dimension);

}  // namespace berth::host
