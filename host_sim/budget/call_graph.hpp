// Worst-case stack: frames from the compiler, calls from the linked code.
//
// GCC's -fcallgraph-info=su leaves a file .ci per source file with every function's stack frame;
// the disassembled image says which function calls which, tail calls and the compiler's own
// routines (division, memcpy) included. Frames of functions that were not compiled here come from
// what their instructions push. An indirect call may reach any function whose address stands in
// the image outside the vector table. No recursion: a cycle is an error.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace berth::host {

/// Stack frames by linker symbol, bytes; the larger one where two files have a function of a name.
using FrameSizes = std::map<std::string, int>;

/// Adds the functions of one .ci file. Error: a frame without a bound.
tl::expected<void, std::string> add_frame_sizes(const std::string& callgraph_info,
                                                FrameSizes& frames);

struct Function {
  std::string name;  // linker symbol
  int pushed_bytes = 0;
  bool calls_indirectly = false;
  std::set<std::uint32_t> callees;  // addresses of functions
};

struct Program {
  std::map<std::uint32_t, Function> functions;  // by address
  std::set<std::uint32_t> addressed;            // functions whose address is a constant somewhere
};

/// Reads what `arm-none-eabi-objdump -d --no-show-raw-insn` prints. `vectors_end`: words below it
/// are the vector table.
Program parse_disassembly(const std::string& text, std::uint32_t vectors_end);

struct StackPath {
  int bytes = 0;
  std::vector<std::string> functions;  // from the entry to the deepest
};

/// The deepest path from `entry`. Error: one line; recursion, or no such function.
tl::expected<StackPath, std::string> deepest_path(const Program& program, const FrameSizes& frames,
                                                  const std::string& entry);

}  // namespace berth::host
