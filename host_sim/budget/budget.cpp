#include "host_sim/budget/budget.hpp"

#include <cxxabi.h>
#include <fmt/format.h>

#include <cstdlib>
#include <iterator>
#include <memory>

#include "image/gradient_rows.hpp"
#include "pipeline/workspace.hpp"

namespace berth::host {
namespace {

// Published limits, millions of instructions. They follow what is reached, and never rise.
constexpr double kMedianLimit_m = 10, kWorstLimit_m = 16, kAdversarialLimit_m = 19;
constexpr double kNearLimit_m = 5.2, kFarLimit_m = 3.0;
constexpr double kNearGoal_m = 6, kFarGoal_m = 3;
constexpr double kMedianGoal_m = 10, kWorstGoal_m = 20;

// Assumptions of the estimate of frame rates; none of them is measured.
constexpr double kCyclesPerInstruction = 1.2;
constexpr double kCyclesPerLine_300 = 60, kCyclesPerLine_100 = 25;  // 32 bytes of external memory
constexpr double kLinesPerFrame = 1.25 * 1024 * 1024 / 32;

double million(double instructions) { return instructions / 1e6; }
double whole_frame(const FrameCount& frame) { return frame.frame; }

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status), &std::free);
  std::string name = status == 0 ? text.get() : symbol;
  for (const char* noise : {"(anonymous namespace)::", "berth::"}) {
    for (auto at = name.find(noise); at != std::string::npos; at = name.find(noise)) {
      name.erase(at, std::string(noise).size());
    }
  }
  return name.substr(0, name.find('('));
}

void add_limits(const Budget& budget, std::string& text) {
  text += "| | used | limit | goal | |\n| --- | ---: | ---: | ---: | --- |\n";
  for (const Limit& l : limits_of(budget)) {
    const double goal = l.goal > 0 ? l.goal : l.limit;
    text += fmt::format("| {} | {:.1f} {} | {:g} | {:g} | {} |\n", l.what, l.used, l.unit, l.limit,
                        goal, l.used <= goal ? "reached" : "not reached");
  }
}

void add_stages(const Budget& budget, std::string& text) {
  text +=
      "| stage | envelope, median | worst | adversarial, worst | tracked, 300 mm | beyond 800 mm "
      "|\n"
      "| --- | ---: | ---: | ---: | ---: | ---: |\n";
  const auto row = [&](const std::string& name, const auto& value) {
    text += fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", name,
                        million(budget.envelope.quantile(0.5, value)),
                        million(budget.envelope.quantile(1, value)),
                        million(budget.adversarial.quantile(1, value)),
                        million(budget.tracked_near.quantile(0.5, value)),
                        million(budget.tracked_far.quantile(0.5, value)));
  };
  for (std::size_t s = 0; s < kStageCount; ++s) {
    const auto of_stage = [s](const FrameCount& frame) { return frame.stages[s]; };
    if (budget.envelope.quantile(1, of_stage) == 0) continue;
    row(stage_name(static_cast<Stage>(s)), of_stage);
  }
  row("**whole frame**", whole_frame);
}

void add_adversarial(const Budget& budget, std::string& text) {
  text += "| image | instructions, M | work units, k |\n| --- | ---: | ---: |\n";
  for (const FrameCount& frame : budget.adversarial.frames) {
    text += fmt::format("| {} | {:.2f} | {:.2f} |\n", frame.name, million(frame.frame),
                        frame.work_units / 1e3);
  }
}

double frames_per_second(double instructions, double clock_hz, double cycles_per_line) {
  return clock_hz / (instructions * kCyclesPerInstruction + kLinesPerFrame * cycles_per_line);
}

void add_rates(const Budget& budget, std::string& text) {
  text += "| | 300 MHz | 100 MHz |\n| --- | ---: | ---: |\n";
  const auto row = [&](const char* name, double instructions) {
    text += fmt::format("| {} | {:.1f} | {:.1f} |\n", name,
                        frames_per_second(instructions, 300e6, kCyclesPerLine_300),
                        frames_per_second(instructions, 100e6, kCyclesPerLine_100));
  };
  row("envelope, median", budget.envelope.quantile(0.5, whole_frame));
  row("tracked at 300 mm, median", budget.tracked_near.quantile(0.5, whole_frame));
  row("tracked beyond 800 mm, median", budget.tracked_far.quantile(0.5, whole_frame));
  row("envelope, worst", budget.envelope.quantile(1, whole_frame));
  row("adversarial, worst", budget.adversarial.quantile(1, whole_frame));
}

void add_modules(const Budget& budget, std::string& text) {
  text += "| folder | code | constants | data |\n| --- | ---: | ---: | ---: |\n";
  ModuleBytes sum;
  for (const auto& [folder, bytes] : budget.modules) {
    text += fmt::format("| {} | {} | {} | {} |\n", folder, bytes.code, bytes.constants, bytes.data);
    sum.code += bytes.code;
    sum.constants += bytes.constants;
    sum.data += bytes.data;
  }
  text += fmt::format("| **all** | {} | {} | {} |\n", sum.code, sum.constants, sum.data);
}

void add_variables(const Budget& budget, std::string& text) {
  text += "| variable | bytes |\n| --- | ---: |\n";
  for (const PlacedSection& variable : budget.variables) {
    const std::string symbol = variable.input.substr(variable.input.find('_'));
    text += fmt::format("| `{}` | {} |\n", demangled(symbol), variable.bytes);
  }
  const std::pair<const char*, std::size_t> parts[] = {
      {"edge pixels", sizeof(Workspace::edge_pixels)},
      {"chains", sizeof(Workspace::chains) + sizeof(Workspace::chain_order) +
                     sizeof(Workspace::chain_rows) + sizeof(Workspace::edge_marks)},
      {"line buffers, or votes", sizeof(Workspace::rows) > sizeof(Workspace::votes)
                                     ? sizeof(Workspace::rows)
                                     : sizeof(Workspace::votes)},
      {"outlines", sizeof(Workspace::outline)},
      {"rings", sizeof(Workspace::rings)}};
  for (const auto& [name, bytes] : parts) {
    text += fmt::format("| of `workspace`: {} | {} |\n", name, bytes);
  }
}

void add_path(const StackPath& path, std::string& text) {
  for (const std::string& function : path.functions) {
    text += fmt::format("- `{}`\n", demangled(function));
  }
}

}  // namespace

std::vector<Limit> limits_of(const Budget& b) {
  const auto kib = [](auto bytes) { return static_cast<double>(bytes) / 1024; };
  const double stack = b.envelope.stack_bytes;
  return {
      {"code and constants", "KiB", kib(b.memory.flash), kib(b.memory.flash_bytes), 0},
      {"on-chip data, stacks included", "KiB", kib(b.memory.ram), kib(b.memory.ram_bytes), 0},
      {"frames, external", "KiB", kib(b.memory.external), kib(b.memory.external_bytes), 0},
      {"application's stack, by the call graph", "KiB", kib(b.application.bytes), kib(stack), 0},
      {"handlers' stack, by the call graph", "KiB", kib(b.handler.bytes), 1, 0},
      {"envelope frame, median", "M", million(b.envelope.quantile(0.5, whole_frame)),
       kMedianLimit_m, kMedianGoal_m},
      {"envelope frame, worst", "M", million(b.envelope.quantile(1, whole_frame)), kWorstLimit_m,
       kWorstGoal_m},
      {"adversarial image, worst", "M", million(b.adversarial.quantile(1, whole_frame)),
       kAdversarialLimit_m, kWorstGoal_m},
      {"tracked at 300 mm, median", "M", million(b.tracked_near.quantile(0.5, whole_frame)),
       kNearLimit_m, kNearGoal_m},
      {"tracked beyond 800 mm, median", "M", million(b.tracked_far.quantile(0.5, whole_frame)),
       kFarLimit_m, kFarGoal_m},
  };
}

std::string budget_text(const Budget& budget) {
  std::string text =
      "# Budgets\n\nWritten by `berthmark budget --out docs/budgets.md`: do not edit. Parts to "
      "fit: "
      "SAMV71Q21RT (300 MHz, 384 KiB of\nSRAM) and SAMRH71F20C (100 MHz, 128 KiB of flash). "
      "Instructions (M: millions) are counted in QEMU, exactly; they\nare no times.\n\n";
  add_limits(budget, text);
  text += fmt::format(
      "\nThe painted stack shows a peak of {:.1f} KiB over all these frames, {:.0f} % of the call "
      "graph's bound.\n\n## Instructions per stage, M\n\n{} frames of the operating envelope, {} "
      "images made to be expensive.\nTracked: medians of frames whose search begins with the last "
      "pose.\n\n",
      budget.adversarial.stack_peak_bytes / 1024.0,
      100.0 * budget.adversarial.stack_peak_bytes / budget.application.bytes,
      budget.envelope.frames.size(), budget.adversarial.frames.size());
  add_stages(budget, text);
  text += "\n## Adversarial images\n\n";
  add_adversarial(budget, text);
  text += fmt::format(
      "\n## Frames per second: an estimate\n\nAssumed, not measured: {:g} cycles per instruction "
      "from cached flash and on-chip memory; a frame's lines of\n32 bytes read 1.25 times, each "
      "{:g} cycles at 300 MHz and {:g} at 100 MHz.\n\n",
      kCyclesPerInstruction, kCyclesPerLine_300, kCyclesPerLine_100);
  add_rates(budget, text);
  text += "\n## Bytes per module\n\n";
  add_modules(budget, text);
  text += "\n## Largest variables\n\n";
  add_variables(budget, text);
  text += fmt::format(
      "\n## Deepest stack\n\n{} bytes by the compiler's frames and the image's calls, no call "
      "leads back to itself; handlers need {} bytes\nof their own stack. From the entry down:\n\n",
      budget.application.bytes, budget.handler.bytes);
  add_path(budget.application, text);
  return text;
}

}  // namespace berth::host
