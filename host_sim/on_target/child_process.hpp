// A child process with pipes, for as long as this object lives.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

namespace berth::host {

/// A file descriptor that is closed with its owner.
class OwnedFd {
 public:
  OwnedFd() = default;
  explicit OwnedFd(int fd) : fd_(fd) {}
  OwnedFd(OwnedFd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  OwnedFd& operator=(OwnedFd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~OwnedFd() { reset(); }

  void reset();
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

struct Pipe {
  OwnedFd read_end, write_end;
};

/// A pipe that children do not inherit unless it is handed to them; both ends invalid on failure.
Pipe make_pipe();

/// A file in memory with these contents, its position at the start.
OwnedFd make_memory_file(const void* bytes, std::size_t size);

/// Descriptor `own` of this process becomes descriptor `in_child` of the child.
struct Inherited {
  int own, in_child;
};

class ChildProcess {
 public:
  ChildProcess() = default;
  ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  ~ChildProcess() { kill_and_wait(); }

  /// Starts `arguments[0]` (searched in PATH), its input from /dev/null. 0, or errno.
  int start(const std::vector<std::string>& arguments, const std::vector<Inherited>& inherited);
  /// Waits for the end: the exit code, or 128 + signal.
  int wait();
  void kill_and_wait();

 private:
  pid_t pid_ = -1;
};

}  // namespace berth::host
