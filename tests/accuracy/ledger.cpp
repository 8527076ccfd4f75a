#include "accuracy/ledger.hpp"

#include <chrono>
#include <cstdio>
#include <sstream>

namespace berth::accuracy {
namespace {

constexpr int kReportEvery_ms = 10000;

long long now_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

}  // namespace

// A whole line ends in " ;".
Ledger::Ledger(const std::string& path) : reported_ms_(now_ms()) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.size() < 2 || line.substr(line.size() - 2) != " ;") continue;
    std::istringstream fields(line.substr(0, line.size() - 2));
    std::string key;
    fields >> key;
    std::vector<double>& numbers = known_[key];
    for (double v; fields >> v;) numbers.push_back(v);
  }
  in.close();
  file_.open(path, std::ios::app);
  file_ << "\n";  // ends a line that was cut
}

std::vector<double> Ledger::values(const std::string& key,
                                   const std::function<std::vector<double>()>& measure) {
  const auto found = known_.find(key);
  if (found != known_.end()) return found->second;
  std::vector<double> numbers = measure();
  ++measured_;
  if (file_.is_open()) {
    file_.precision(9);
    file_ << key;
    for (const double v : numbers) file_ << ' ' << v;
    file_ << " ;" << std::endl;
  }
  report(key);
  return numbers;
}

void Ledger::report(const std::string& key) {
  if (!file_.is_open() || now_ms() - reported_ms_ < kReportEvery_ms) return;
  reported_ms_ = now_ms();
  std::fprintf(stderr, "%ld trials measured, at %s\n", measured_, key.c_str());
}

}  // namespace berth::accuracy
