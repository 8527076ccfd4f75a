// Worker threads: order, backpressure, stopping, errors.
#include "host_sim/replay/parallel.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "program.hpp"

namespace berth::host {
namespace {

constexpr int kFrames = 60;

/// A folder of files that are never read: only their order counts here.
struct Frames {
  Workplace place;
  Frames() {
    for (int i = 0; i < kFrames; ++i) place.write("f/" + std::to_string(i) + ".png", "x");
  }
  FrameSource open() const { return *FrameSource::open({place.path("f").string()}); }
};

FrameWork uneven_work() {
  return [](const FrameJob& job) {
    std::this_thread::sleep_for(std::chrono::microseconds(job.index % 5 * 300));
    FrameOutcome outcome;
    outcome.index = job.index;
    outcome.record.file = job.name;
    return outcome;
  };
}

TEST(Parallel, DeliversInOrderWithoutGaps) {
  const Frames frames;
  for (const int jobs : {1, 2, 7}) {
    FrameSource source = frames.open();
    const std::atomic<bool> stop{false};
    std::size_t next = 0;
    run_in_order(
        source, jobs, uneven_work,
        [&](const FrameOutcome& outcome) {
          EXPECT_EQ(outcome.index, next);
          EXPECT_EQ(outcome.record.file, std::to_string(next) + ".png");
          ++next;
        },
        stop);
    EXPECT_EQ(next, std::size_t{kFrames});
  }
}

TEST(Parallel, StopDeliversWhatWasBegun) {
  const Frames frames;
  FrameSource source = frames.open();
  std::atomic<bool> stop{false};
  std::size_t delivered = 0;
  run_in_order(
      source, 3, uneven_work,
      [&](const FrameOutcome& outcome) {
        EXPECT_EQ(outcome.index, delivered);
        if (++delivered == 10) stop = true;
      },
      stop);
  EXPECT_GE(delivered, 10u);
  EXPECT_LT(delivered, std::size_t{kFrames});
}

TEST(Parallel, ErrorOfAWorkerComesOut) {
  const Frames frames;
  FrameSource source = frames.open();
  const std::atomic<bool> stop{false};
  const auto failing = [] {
    return [](const FrameJob& job) -> FrameOutcome {
      if (job.index == 20) throw std::runtime_error("disk full");
      FrameOutcome outcome;
      outcome.index = job.index;
      return outcome;
    };
  };
  EXPECT_THROW(run_in_order(
                   source, 3, failing, [](const FrameOutcome&) {}, stop),
               std::runtime_error);
}

TEST(Parallel, ErrorOfTheReceiverEndsTheRun) {
  const Frames frames;
  FrameSource source = frames.open();
  const std::atomic<bool> stop{false};
  EXPECT_THROW(run_in_order(
                   source, 3, uneven_work,
                   [](const FrameOutcome& outcome) {
                     if (outcome.index == 5) throw std::runtime_error("cannot write");
                   },
                   stop),
               std::runtime_error);
}

}  // namespace
}  // namespace berth::host
