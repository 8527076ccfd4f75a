// The heap that a function holds at its worst, by counting what the calling thread allocates.
#pragma once

#include <cstddef>

namespace berth::bench {

/// Counts from construction on. Programs that link allocation_peak.cpp count malloc and its
/// relatives (and so operator new and cv::Mat); not under sanitizers, which have their own.
class AllocationPeak {
 public:
  AllocationPeak();
  std::size_t bytes() const;  // at the worst, beyond what was held at the start

 private:
  long long start_;
};

}  // namespace berth::bench
