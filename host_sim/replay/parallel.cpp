#include "host_sim/replay/parallel.hpp"

#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace berth::host {
namespace {

constexpr std::size_t kFramesPerWorker = 4;

class OrderedRun {
 public:
  OrderedRun(FrameSource& source, int jobs, const std::atomic<bool>& stop)
      : source_(source), stop_(stop), running_(jobs), window_(kFramesPerWorker * jobs) {}

  /// A worker thread's life.
  void work(const std::function<FrameWork()>& make_worker) {
    try {
      const FrameWork worker = make_worker();
      while (auto job = take()) put(worker(std::move(*job)));
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_all();
  }

  /// The next outcome in order; nothing when all workers are done.
  std::optional<FrameOutcome> get() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ || running_ == 0 || done_.count(next_) != 0; });
    if (error_) std::rethrow_exception(error_);
    const auto found = done_.find(next_);
    if (found == done_.end()) return std::nullopt;
    FrameOutcome outcome = std::move(found->second);
    done_.erase(found);
    ++next_;
    changed_.notify_all();
    return outcome;
  }

  void abandon() {
    const std::lock_guard lock(mutex_);
    abandoned_ = true;
    changed_.notify_all();
  }

 private:
  std::optional<FrameJob> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ || abandoned_ || taken_ < next_ + window_; });
    if (error_ || abandoned_ || stop_) return std::nullopt;
    auto job = source_.next();
    if (job) ++taken_;
    return job;
  }

  void put(FrameOutcome outcome) {
    const std::lock_guard lock(mutex_);
    const std::size_t index = outcome.index;
    done_.emplace(index, std::move(outcome));
    changed_.notify_all();
  }

  FrameSource& source_;
  const std::atomic<bool>& stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, FrameOutcome> done_;
  std::exception_ptr error_;
  bool abandoned_ = false;
  int running_;
  std::size_t window_;
  std::size_t taken_ = 0;  // frames handed to workers
  std::size_t next_ = 0;   // frame to be delivered next
};

}  // namespace

void run_in_order(FrameSource& source, int jobs, const std::function<FrameWork()>& make_worker,
                  const std::function<void(FrameOutcome)>& deliver, const std::atomic<bool>& stop) {
  OrderedRun run(source, jobs, stop);
  std::vector<std::thread> threads;
  for (int i = 0; i < jobs; ++i) threads.emplace_back([&] { run.work(make_worker); });
  std::exception_ptr error;
  try {
    while (auto outcome = run.get()) deliver(std::move(*outcome));
  } catch (...) {
    error = std::current_exception();
    run.abandon();
  }
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace berth::host
