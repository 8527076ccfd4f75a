#include "bench/common/in_parallel.hpp"

#include <atomic>
#include <cstdio>
#include <thread>
#include <vector>

namespace berth::bench {

void in_parallel(int count, int jobs, const char* name, const std::function<FrameWork()>& make) {
  std::atomic<int> next{0}, done{0};
  const auto run = [&] {
    const FrameWork work = make();
    for (int i = next++; i < count; i = next++) {
      work(i);
      std::fprintf(stderr, "\r%s: %d of %d", name, ++done, count);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  std::fputc('\n', stderr);
}

}  // namespace berth::bench
