// Damaged copies of good files, as text.
#pragma once

#include <string>

namespace berth::host {

/// The text with the first `what` replaced; `what` must occur.
inline std::string with(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  if (at == std::string::npos) return "not found: " + what;
  return text.replace(at, what.size(), by);
}

/// The text without the line that contains `what`.
inline std::string without_line(std::string text, const std::string& what) {
  const size_t at = text.find(what);
  if (at == std::string::npos) return "not found: " + what;
  const size_t begin = text.rfind('\n', at) + 1;
  return text.erase(begin, text.find('\n', at) + 1 - begin);
}

}  // namespace berth::host
