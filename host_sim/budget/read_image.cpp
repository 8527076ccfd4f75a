#include "host_sim/budget/read_image.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

namespace berth::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargeVariable = 256;
constexpr const char* kApplicationEntry = "reset_handler";
constexpr const char* kHandlerEntry = "fault_handler";

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

tl::expected<std::string, std::string> disassemble(const std::string& image) {
  const std::string command = "arm-none-eabi-objdump -d --no-show-raw-insn '" + image + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), &::pclose);
  std::string text;
  std::array<char, 65536> part;
  while (pipe) {
    const std::size_t count = std::fread(part.data(), 1, part.size(), pipe.get());
    if (count == 0) break;
    text.append(part.data(), count);
  }
  if (text.empty()) {
    return tl::unexpected(
        std::string("cannot run arm-none-eabi-objdump: apt-get install gcc-arm-none-eabi"));
  }
  return text;
}

void read_memory(const std::string& map, const std::vector<PlacedSection>& sections,
                 MemoryUse& memory) {
  for (const MemoryRegion& region : parse_memory_regions(map)) {
    std::uint64_t end = region.origin;
    for (const PlacedSection& s : sections) {
      if (s.address < region.origin || s.address >= region.origin + region.bytes) continue;
      end = std::max(end, s.address + s.bytes);
    }
    const std::uint64_t used = end - region.origin;
    if (region.name == "FLASH") memory.flash += used, memory.flash_bytes += region.bytes;
    if (region.name == "PARAMETERS")
      memory.flash += region.bytes, memory.flash_bytes += region.bytes;
    if (region.name == "RAM") memory.ram = used, memory.ram_bytes = region.bytes;
    if (region.name == "EXTERNAL") memory.external = used, memory.external_bytes = region.bytes;
  }
  for (const PlacedSection& s : sections) {
    if (s.output == ".data") memory.flash += s.bytes;  // its initial values
  }
}

std::vector<PlacedSection> large_variables(const std::vector<PlacedSection>& sections) {
  std::vector<PlacedSection> variables;
  for (const PlacedSection& s : sections) {
    const bool is_data = s.output == ".bss" || s.output == ".noinit" || s.output == ".data";
    if (is_data && s.bytes >= kLargeVariable) variables.push_back(s);
  }
  std::sort(variables.begin(), variables.end(),
            [](const PlacedSection& a, const PlacedSection& b) { return a.bytes > b.bytes; });
  return variables;
}

std::uint32_t bytes_of_vectors(const std::vector<PlacedSection>& sections) {
  for (const PlacedSection& s : sections) {
    if (s.input == ".vectors") return static_cast<std::uint32_t>(s.address + s.bytes);
  }
  return 0;
}

/// The .ci files of everything but tests: folders by object, and stack frames.
tl::expected<void, std::string> read_compiler_files(const fs::path& folder, FolderOfObject& folders,
                                                    FrameSizes& frames) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".ci") continue;
    const std::string module = source_folder(entry.path().lexically_relative(folder).string());
    if (module.rfind("tests", 0) == 0) continue;
    folders[entry.path().stem().string() + ".obj"] = module;
    const auto added = add_frame_sizes(read_file(entry.path()), frames);
    if (!added) return added;
  }
  if (!frames.empty()) return {};
  return tl::unexpected(
      folder.string() +
      ": no .ci files of the compiler; build with cmake --build --preset firmware");
}

}  // namespace

tl::expected<void, std::string> read_image(const std::string& image, Budget& budget) {
  const fs::path map_path = fs::path(image).replace_extension(".map");
  if (!fs::exists(image) || !fs::exists(map_path)) {
    return tl::unexpected(image +
                          " or its map is missing: cmake --preset firmware && cmake --build "
                          "--preset firmware");
  }
  const std::string map = read_file(map_path);
  const auto sections = parse_link_map(map);
  if (!sections) return tl::unexpected(map_path.string() + ": " + sections.error());
  FolderOfObject folders;
  FrameSizes frames;
  const fs::path folder = fs::absolute(image).parent_path();
  if (const auto read = read_compiler_files(folder, folders, frames); !read) return read;
  read_memory(map, *sections, budget.memory);
  budget.modules = bytes_per_module(*sections, folders);
  budget.variables = large_variables(*sections);
  const auto text = disassemble(image);
  if (!text) return tl::unexpected(text.error());
  const Program program = parse_disassembly(*text, bytes_of_vectors(*sections));
  auto application = deepest_path(program, frames, kApplicationEntry);
  if (!application) return tl::unexpected(application.error());
  auto handler = deepest_path(program, frames, kHandlerEntry);
  if (!handler) return tl::unexpected(handler.error());
  budget.application = std::move(*application);
  budget.handler = std::move(*handler);
  return {};
}

}  // namespace berth::host
