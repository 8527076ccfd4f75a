#include "host_sim/campaign/ordered_rows.hpp"

#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace berth::host {
namespace {

class OrderedRows {
 public:
  OrderedRows(uint64_t first, uint64_t end, int jobs, const std::atomic<bool>& stop)
      : next_taken_(first), next_(first), end_(end), running_(jobs), stop_(stop) {}

  /// A thread's life.
  void work(const std::function<RowWork()>& make_worker) {
    try {
      const RowWork worker = make_worker();
      while (const auto index = take()) put(*index, worker(*index));
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_all();
  }

  /// The next row in order; nothing when all threads are done.
  std::optional<std::string> get() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ || running_ == 0 || done_.count(next_) != 0; });
    const auto found = done_.find(next_);
    if (error_ || found == done_.end()) return std::nullopt;
    std::string row = std::move(found->second);
    done_.erase(found);
    ++next_;
    return row;
  }

  void abandon() { abandoned_ = true; }
  std::exception_ptr error() const { return error_; }

 private:
  std::optional<uint64_t> take() {
    const std::lock_guard lock(mutex_);
    if (error_ || abandoned_ || stop_ || next_taken_ >= end_) return std::nullopt;
    return next_taken_++;
  }

  void put(uint64_t index, std::string row) {
    const std::lock_guard lock(mutex_);
    done_.emplace(index, std::move(row));
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<uint64_t, std::string> done_;
  std::exception_ptr error_;
  std::atomic<bool> abandoned_{false};
  uint64_t next_taken_;  // to be computed next
  uint64_t next_;        // to be delivered next
  const uint64_t end_;
  int running_;
  const std::atomic<bool>& stop_;
};

}  // namespace

void run_rows(uint64_t first, uint64_t end, int jobs, const std::function<RowWork()>& make_worker,
              const std::function<bool(const std::string&)>& deliver,
              const std::atomic<bool>& stop) {
  OrderedRows run(first, end, jobs, stop);
  std::vector<std::thread> threads;
  for (int i = 0; i < jobs; ++i) threads.emplace_back([&] { run.work(make_worker); });
  while (const auto row = run.get()) {
    if (!deliver(*row)) run.abandon();
  }
  for (std::thread& thread : threads) thread.join();
  if (run.error()) std::rethrow_exception(run.error());
}

}  // namespace berth::host
