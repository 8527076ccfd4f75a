// Results of a long run as they come in: one line per trial, so that an interrupted run goes on.
//
// A line is the trial's key and its numbers, space separated; the first line names the run. What
// stands in the file is not measured again, so a file belongs to one build of the estimator.
#pragma once

#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace berth::accuracy {

class Ledger {
 public:
  /// Without a file: measures everything, keeps nothing.
  Ledger() = default;
  /// Reads what `path` holds and appends to it; a last line that was cut is measured again.
  explicit Ledger(const std::string& path);

  /// The numbers of a trial: from the file, or measured and written. Prints a line of progress on
  /// standard error every ten seconds of measuring.
  std::vector<double> values(const std::string& key,
                             const std::function<std::vector<double>()>& measure);

 private:
  void report(const std::string& key);

  std::map<std::string, std::vector<double>> known_;
  std::ofstream file_;
  long measured_ = 0;
  long long reported_ms_ = 0;
};

}  // namespace berth::accuracy
