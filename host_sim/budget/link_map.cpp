#include "host_sim/budget/link_map.hpp"

#include <regex>
#include <sstream>

namespace berth::host {
namespace {

constexpr const char* kPlacements = "Linker script and memory map";
constexpr const char* kRegions = "Memory Configuration";

// "algo/libberth_algo.a(link.cpp.obj)" and "firmware/main/.../main.cpp.obj"
std::string object_name(const std::string& path) {
  const auto begin = path.find_last_of("/(");
  std::string name = begin == std::string::npos ? path : path.substr(begin + 1);
  if (!name.empty() && name.back() == ')') name.pop_back();
  return name;
}

bool is_loaded(const std::string& output) {
  return output.rfind(".debug", 0) != 0 && output != ".comment" && output != ".ARM.attributes";
}

class MapReader {
 public:
  std::vector<PlacedSection> read(std::istream& lines) {
    for (std::string line; std::getline(lines, line);) take(line);
    return std::move(placed_);
  }

 private:
  // An output section starts in the first column; an input section in the second, with address,
  // size and object on the same line or, after a long name, on the next one. "*fill*" is padding.
  void take(const std::string& line) {
    static const std::regex output(R"(^(\.[\w.]+)(\s.*)?$)");
    static const std::regex input(R"(^ (\.[\w.$]+|COMMON)(\s+0x.*)?$)");
    static const std::regex placement(R"(^\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)\s+(\S.*)$)");
    std::smatch match;
    if (std::regex_match(line, match, output)) {
      output_ = match[1];
      input_.clear();
      return;
    }
    std::string rest = line;
    if (std::regex_match(line, match, input)) {
      input_ = match[1];
      rest = match[2];
    }
    if (input_.empty() || !std::regex_match(rest, match, placement)) return;
    const std::uint64_t bytes = std::stoull(match[2], nullptr, 16);
    if (bytes > 0 && is_loaded(output_)) {
      placed_.push_back(
          {output_, input_, object_name(match[3]), std::stoull(match[1], nullptr, 16), bytes});
    }
    input_.clear();
  }

  std::string output_, input_;
  std::vector<PlacedSection> placed_;
};

}  // namespace

tl::expected<std::vector<PlacedSection>, std::string> parse_link_map(const std::string& text) {
  const auto begin = text.find(kPlacements);
  if (begin == std::string::npos) {
    return tl::unexpected(std::string("no map of GNU ld: \"") + kPlacements + "\" is missing");
  }
  std::istringstream lines(text.substr(begin));
  return MapReader().read(lines);
}

std::vector<MemoryRegion> parse_memory_regions(const std::string& text) {
  std::vector<MemoryRegion> regions;
  const auto begin = text.find(kRegions);
  if (begin == std::string::npos) return regions;
  std::istringstream lines(text.substr(begin, text.find(kPlacements) - begin));
  static const std::regex region(R"(^(\w+)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+).*$)");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, region)) continue;
    regions.push_back(
        {match[1], std::stoull(match[2], nullptr, 16), std::stoull(match[3], nullptr, 16)});
  }
  return regions;
}

}  // namespace berth::host
