#include "host_sim/budget/call_graph.hpp"

#include <algorithm>
#include <optional>
#include <regex>
#include <sstream>

namespace berth::host {
namespace {

// A title is the symbol, behind "file:" for a function that only this file sees.
std::string symbol_of(const std::string& title) {
  const auto colon = title.rfind(':');
  return colon == std::string::npos ? title : title.substr(colon + 1);
}

// "{r4, r5, lr}", "{r0-r3}": how many.
int count_registers(const std::string& list) {
  static const std::regex item(R"((\w+)(?:-(\w+))?)");
  int count = 0;
  for (std::sregex_iterator it(list.begin(), list.end(), item), end; it != end; ++it) {
    const std::string from = (*it)[1], to = (*it)[2];
    count += to.empty() ? 1 : std::stoi(to.substr(1)) - std::stoi(from.substr(1)) + 1;
  }
  return count;
}

int pushed_by(const std::string& mnemonic, const std::string& operands) {
  static const std::regex store(R"(.*\[sp, #-(\d+)\]!.*)"), sub(R"(sp,(?: sp,)? #(\d+).*)");
  std::smatch match;
  if (mnemonic.rfind("push", 0) == 0) return 4 * count_registers(operands);
  if (mnemonic.rfind("stmdb", 0) == 0 && operands.rfind("sp!", 0) == 0) {
    return 4 * count_registers(operands.substr(operands.find('{')));
  }
  if (mnemonic.rfind("sub", 0) == 0 && std::regex_match(operands, match, sub)) {
    return std::stoi(match[1]);
  }
  if (mnemonic.rfind("str", 0) == 0 && std::regex_match(operands, match, store)) {
    return std::stoi(match[1]);
  }
  return 0;
}

class Disassembly {
 public:
  explicit Disassembly(std::uint32_t vectors_end) : vectors_end_(vectors_end) {}

  Program read(std::istream& lines) {
    for (std::string line; std::getline(lines, line);) take(line);
    resolve();
    return std::move(program_);
  }

 private:
  void take(const std::string& line) {
    static const std::regex header(R"(^([0-9a-f]{8}) <(.+)>:$)");
    static const std::regex instruction(R"(^\s+([0-9a-f]+):\t(\S+)(?:\t(.*))?$)");
    std::smatch match;
    if (std::regex_match(line, match, header)) {
      current_ = static_cast<std::uint32_t>(std::stoul(match[1], nullptr, 16));
      program_.functions[current_].name = match[2];
    } else if (std::regex_match(line, match, instruction)) {
      const auto at = static_cast<std::uint32_t>(std::stoul(match[1], nullptr, 16));
      add(at, match[2], match[3]);
    }
  }

  void add(std::uint32_t at, const std::string& mnemonic, const std::string& operands) {
    if (mnemonic == ".word") {
      if (at >= vectors_end_) words_.insert(std::stoul(operands, nullptr, 16));
      return;
    }
    Function& function = program_.functions[current_];
    function.pushed_bytes += pushed_by(mnemonic, operands);
    static const std::regex target(R"(^(?:\w+, )?([0-9a-f]+) <.*$)");
    std::smatch match;
    const bool is_register = operands.rfind('r', 0) == 0 || operands.rfind("ip", 0) == 0;
    if ((mnemonic == "blx" || mnemonic == "bx") && is_register) function.calls_indirectly = true;
    const bool is_branch = mnemonic[0] == 'b' || mnemonic[0] == 'c';  // bl, b.w, beq.n, cbz
    if (!is_branch || !std::regex_match(operands, match, target)) return;
    const auto callee = static_cast<std::uint32_t>(std::stoul(match[1], nullptr, 16));
    if (callee != current_ || mnemonic == "bl") function.callees.insert(callee);
  }

  // Branch targets inside of functions are no calls, nor is a jump back to a function's start;
  // words that are a function's address in Thumb code, odd, are references.
  void resolve() {
    for (auto& entry : program_.functions) {
      Function& function = entry.second;
      std::set<std::uint32_t> callees;
      for (const std::uint32_t target : function.callees) {
        if (program_.functions.count(target) != 0) callees.insert(target);
      }
      function.callees = callees;
    }
    for (const unsigned long word : words_) {
      const auto address = static_cast<std::uint32_t>(word) - 1;
      if ((word & 1) != 0 && program_.functions.count(address) != 0) {
        program_.addressed.insert(address);
      }
    }
  }

  std::uint32_t vectors_end_, current_ = 0;
  std::set<unsigned long> words_;
  Program program_;
};

class DepthSearch {
 public:
  DepthSearch(const Program& program, const FrameSizes& frames)
      : program_(program), frames_(frames) {}

  tl::expected<StackPath, std::string> visit(std::uint32_t address) {
    if (const auto known = done_.find(address); known != done_.end()) return known->second;
    const Function& function = program_.functions.at(address);
    if (!open_.insert(address).second) {
      return tl::unexpected(function.name + " calls itself, on the way through other functions");
    }
    StackPath deepest;
    for (const std::uint32_t callee : callees_of(function)) {
      auto path = visit(callee);
      if (!path) return path;
      if (path->bytes > deepest.bytes) deepest = std::move(*path);
    }
    open_.erase(address);
    const auto frame = frames_.find(function.name);
    deepest.bytes += frame != frames_.end() ? frame->second : function.pushed_bytes;
    deepest.functions.insert(deepest.functions.begin(), function.name);
    return done_[address] = deepest;
  }

 private:
  std::set<std::uint32_t> callees_of(const Function& function) const {
    std::set<std::uint32_t> callees = function.callees;
    if (function.calls_indirectly) {
      callees.insert(program_.addressed.begin(), program_.addressed.end());
    }
    return callees;
  }

  const Program& program_;
  const FrameSizes& frames_;
  std::map<std::uint32_t, StackPath> done_;
  std::set<std::uint32_t> open_;
};

}  // namespace

tl::expected<void, std::string> add_frame_sizes(const std::string& callgraph_info,
                                                FrameSizes& frames) {
  static const std::regex node(
      R"re(node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes \(([^)]*)\)[^"]*")re");
  const auto begin = std::sregex_iterator(callgraph_info.begin(), callgraph_info.end(), node);
  for (auto it = begin; it != std::sregex_iterator(); ++it) {
    const std::string symbol = symbol_of((*it)[1]), kind = (*it)[3];
    if (kind.rfind("dynamic", 0) == 0 && kind.find("bounded") == std::string::npos) {
      return tl::unexpected(symbol + ": its stack frame has no bound; use fixed-size arrays");
    }
    int& bytes = frames[symbol];
    bytes = std::max(bytes, std::stoi((*it)[2]));
  }
  return {};
}

Program parse_disassembly(const std::string& text, std::uint32_t vectors_end) {
  std::istringstream lines(text);
  return Disassembly(vectors_end).read(lines);
}

tl::expected<StackPath, std::string> deepest_path(const Program& program, const FrameSizes& frames,
                                                  const std::string& entry) {
  for (const auto& [address, function] : program.functions) {
    if (function.name == entry) return DepthSearch(program, frames).visit(address);
  }
  return tl::unexpected("the image has no function " + entry);
}

}  // namespace berth::host
