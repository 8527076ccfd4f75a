// What the linker placed where: GNU ld's map file, taken apart.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace berth::host {

/// One input section that is in the image.
struct PlacedSection {
  std::string output;  // ".text", ".bss", ...
  std::string input;   // ".text._ZN5berth...", ".rodata.str1.4", ...
  std::string object;  // "gradient_rows.cpp.obj", without folder and archive
  std::uint64_t address = 0, bytes = 0;
};

/// The placed sections of a map file, in its order; sections of no bytes and debug sections are
/// left out. Error: one line that says what is missing.
tl::expected<std::vector<PlacedSection>, std::string> parse_link_map(const std::string& text);

/// A memory of the image: what the linker script declares under MEMORY.
struct MemoryRegion {
  std::string name;
  std::uint64_t origin = 0, bytes = 0;
};
std::vector<MemoryRegion> parse_memory_regions(const std::string& text);

}  // namespace berth::host
