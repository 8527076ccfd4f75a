#include "host_sim/on_target/on_target.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <thread>

#include "host_sim/decode/decode.hpp"
#include "host_sim/on_target/child_process.hpp"

namespace berth::host {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Result = tl::expected<Bytes, std::string>;

// Descriptors of QEMU's process.
constexpr int kFramesFd = 3, kParametersFd = 4, kSerialFd = 5;
constexpr const char* kParameterAddress = "0x1fc00";  // linker/mps2_an500.ld

std::vector<std::string> qemu_arguments(const TargetOptions& options, const std::string& image) {
  const auto path = [](int fd) { return "/dev/fd/" + std::to_string(fd); };
  return {
      options.qemu, "-M", "mps2-an500", "-cpu", "cortex-m7", "-display", "none", "-monitor", "none",
      // One instruction is one nanosecond of virtual time: counts repeat exactly.
      "-icount", "shift=0", "-semihosting-config",
      "enable=on,target=native,arg=berthmark,arg=" + path(kFramesFd), "-chardev",
      "file,id=line,path=" + path(kSerialFd), "-serial", "chardev:line", "-device",
      "loader,force-raw=on,addr=" + std::string(kParameterAddress) + ",file=" + path(kParametersFd),
      "-kernel", image};
}

// The parameter area: byte count and block (hal/memory.hpp).
Bytes parameter_area(Span<const std::uint8_t> block) {
  Bytes area;
  for (int i = 0; i < 4; ++i) area.push_back(static_cast<std::uint8_t>(block.size() >> (8 * i)));
  area.insert(area.end(), block.begin(), block.end());
  return area;
}

enum class ReadEnd { kClosed, kSilent, kFailed };

ReadEnd read_line(int fd, const TargetOptions& options, Bytes& bytes) {
  std::uint8_t portion[4096];
  for (;;) {
    pollfd waiting{fd, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, options.silence_timeout_s * 1000);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return ReadEnd::kSilent;
    const ssize_t count = ::read(fd, portion, sizeof portion);
    if (count == 0) return ReadEnd::kClosed;
    if (count < 0) return ReadEnd::kFailed;
    const auto size = static_cast<std::size_t>(count);
    bytes.insert(bytes.end(), portion, portion + size);
    if (options.on_bytes) options.on_bytes({portion, size});
  }
}

// What the image says about parameters that it refuses, else what QEMU says.
std::string explain(int exit_code, const Bytes& bytes, int error_fd) {
  if (const auto telemetry = decode_telemetry(bytes)) {
    if (!telemetry->boots.empty() && telemetry->boots.back().parameter_code != 0) {
      return std::string("the firmware refuses the parameter block: ") +
             telemetry->boots.back().parameter_text;
    }
  }
  char text[400] = {};
  const ssize_t count = ::pread(error_fd, text, sizeof text - 1, 0);
  std::string said(text, count > 0 ? static_cast<std::size_t>(count) : 0);
  said = said.substr(0, said.find('\n'));
  return "the firmware run ended with code " + std::to_string(exit_code) +
         (said.empty() ? "" : ": " + said);
}

std::string explain_start(int error, const std::string& qemu) {
  if (error == ENOENT) {
    return qemu + " is not installed: apt-get install qemu-system-arm";
  }
  return "cannot start " + qemu + ": " + std::strerror(error);
}

}  // namespace

std::string default_image_path() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path().parent_path() / "firmware" / "berthmark.elf").string();
}

Result run_on_target(const TargetFrameSource& frames, Span<const std::uint8_t> parameter_block,
                     const TargetOptions& options) {
  const std::string image = options.image.empty() ? default_image_path() : options.image;
  if (!std::filesystem::exists(image)) {
    return tl::unexpected("no firmware image " + image +
                          ": cmake --preset firmware && cmake --build --preset firmware "
                          "(needs gcc-arm-none-eabi)");
  }
  Pipe frame_pipe = make_pipe(), serial_pipe = make_pipe();
  const Bytes area = parameter_area(parameter_block);
  const OwnedFd parameters = make_memory_file(area.data(), area.size());
  const OwnedFd errors = make_memory_file("", 0);
  if (!frame_pipe.read_end || !serial_pipe.read_end || !parameters || !errors) {
    return tl::unexpected(std::string("cannot make pipes to QEMU: ") + std::strerror(errno));
  }
  ChildProcess qemu;
  const int error =
      qemu.start(qemu_arguments(options, image), {{errors.get(), STDOUT_FILENO},
                                                  {errors.get(), STDERR_FILENO},
                                                  {frame_pipe.read_end.get(), kFramesFd},
                                                  {parameters.get(), kParametersFd},
                                                  {serial_pipe.write_end.get(), kSerialFd}});
  if (error != 0) return tl::unexpected(explain_start(error, options.qemu));
  frame_pipe.read_end.reset();
  serial_pipe.write_end.reset();
  std::thread writer([&] {
    write_frames(frames, frame_pipe.write_end.get());
    frame_pipe.write_end.reset();
  });
  Bytes bytes;
  const ReadEnd end = read_line(serial_pipe.read_end.get(), options, bytes);
  if (end != ReadEnd::kClosed) qemu.kill_and_wait();
  const int exit_code = end == ReadEnd::kClosed ? qemu.wait() : -1;
  writer.join();  // its pipe has lost its reader at the latest now
  if (end == ReadEnd::kSilent) {
    return tl::unexpected("the firmware in QEMU sent nothing for " +
                          std::to_string(options.silence_timeout_s) + " s");
  }
  if (exit_code != 0) return tl::unexpected(explain(exit_code, bytes, errors.get()));
  return bytes;
}

}  // namespace berth::host
