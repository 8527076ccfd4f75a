#include "host_sim/budget/modules.hpp"

#include <filesystem>

namespace berth::host {
namespace {

constexpr const char* kLibraries = "compiler and C library";

bool starts_with(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

std::uint64_t& column(const PlacedSection& section, ModuleBytes& bytes) {
  if (section.output != ".text") return bytes.data;
  const bool is_code = starts_with(section.input, ".text") || section.input == ".vectors";
  return is_code ? bytes.code : bytes.constants;
}

}  // namespace

std::string source_folder(const std::string& built_file) {
  std::filesystem::path folder;
  bool is_after_cmake_files = false;
  for (const auto& part : std::filesystem::path(built_file).parent_path()) {
    if (part == "CMakeFiles") {
      is_after_cmake_files = true;
    } else if (is_after_cmake_files) {
      is_after_cmake_files = false;  // the target's name
    } else {
      folder /= part == "__" ? ".." : part;
    }
  }
  return folder.lexically_normal().string();
}

std::map<std::string, ModuleBytes> bytes_per_module(const std::vector<PlacedSection>& sections,
                                                    const FolderOfObject& folders) {
  std::map<std::string, ModuleBytes> modules;
  for (const PlacedSection& section : sections) {
    if (section.output == ".external") continue;
    const auto folder = folders.find(section.object);
    column(section, modules[folder != folders.end() ? folder->second : kLibraries]) +=
        section.bytes;
  }
  return modules;
}

}  // namespace berth::host
