#include "host_sim/on_target/child_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

extern char** environ;

namespace berth::host {

void OwnedFd::reset() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

Pipe make_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return {};
  constexpr int kFrameBytes = 1 << 20;
  ::fcntl(ends[1], F_SETPIPE_SZ, kFrameBytes);  // fewer turns; without it, it works as well
  return {OwnedFd(ends[0]), OwnedFd(ends[1])};
}

OwnedFd make_memory_file(const void* bytes, std::size_t size) {
  OwnedFd file(::memfd_create("berthmark", MFD_CLOEXEC));
  if (file && ::pwrite(file.get(), bytes, size, 0) != static_cast<ssize_t>(size)) file.reset();
  return file;
}

int ChildProcess::start(const std::vector<std::string>& arguments,
                        const std::vector<Inherited>& inherited) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  // In two steps: a target number may be one that is still to be copied from.
  constexpr int kParkedFrom = 100;
  for (const Inherited& fd : inherited) {
    ::posix_spawn_file_actions_adddup2(&actions, fd.own, kParkedFrom + fd.in_child);
  }
  for (const Inherited& fd : inherited) {
    ::posix_spawn_file_actions_adddup2(&actions, kParkedFrom + fd.in_child, fd.in_child);
    ::posix_spawn_file_actions_addclose(&actions, kParkedFrom + fd.in_child);
  }
  const int error = ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) pid_ = -1;
  return error;
}

int ChildProcess::wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void ChildProcess::kill_and_wait() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  wait();
}

}  // namespace berth::host
