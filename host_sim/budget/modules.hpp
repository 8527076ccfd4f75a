// Bytes of code, constants and data per folder of the source tree.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host_sim/budget/link_map.hpp"

namespace berth::host {

/// The folder that an object was compiled from, by the object's name: "algo/edge" of
/// "link.cpp.obj".
using FolderOfObject = std::map<std::string, std::string>;

/// Folder of a file in a CMake build tree, as a path from the source tree's root:
/// "firmware/storage" of "firmware/main/CMakeFiles/berthmark.dir/__/storage/storage.cpp.ci".
std::string source_folder(const std::string& built_file);

struct ModuleBytes {
  std::uint64_t code = 0, constants = 0, data = 0;
};

/// By folder; objects that are not in `folders` are "compiler and C library".
std::map<std::string, ModuleBytes> bytes_per_module(const std::vector<PlacedSection>& sections,
                                                    const FolderOfObject& folders);

}  // namespace berth::host
