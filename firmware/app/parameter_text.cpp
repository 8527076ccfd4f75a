#include "app/parameter_block.hpp"

namespace berth {
namespace {

/// Appends to a text of fixed size and keeps it NUL-terminated.
class Text {
 public:
  explicit Text(Span<char> out) : out_(out) { terminate(); }

  void add(char c) {
    if (size_ + 1 < out_.size()) out_[size_++] = c;
    terminate();
  }
  void add(const char* text) {
    for (std::size_t i = 0; i < kBlockText_bytes && text[i] != '\0'; ++i) add(text[i]);
  }

 private:
  void terminate() {
    if (!out_.empty()) out_[size_] = '\0';
  }

  Span<char> out_;
  std::size_t size_ = 0;
};

const char* summary(BlockCode code) {
  switch (code) {
    case BlockCode::kOk:
      return "ok";
    case BlockCode::kTooShort:
      return "too short for a parameter block";
    case BlockCode::kMagic:
      return "not a parameter block (does not begin with BPAR)";
    case BlockCode::kLength:
      return "length: the block is cut off or has bytes behind it";
    case BlockCode::kCrc:
      return "CRC does not match: the block is damaged";
    case BlockCode::kVersion:
      return "version is not supported";
    case BlockCode::kUnknownSection:
      return "unknown section";
    case BlockCode::kDuplicateSection:
      return "section stands twice";
    case BlockCode::kMissingSection:
      return "missing section";
    case BlockCode::kSectionLength:
      return "wrong length of section";
    case BlockCode::kOutOfRange:
      return "value out of range";
  }
  return "unknown error";
}

/// The field's name with its index (one digit) between the brackets.
void add_field(Text& text, const FieldFault& fault) {
  for (std::size_t i = 0; i < kBlockText_bytes && fault.field[i] != '\0'; ++i) {
    text.add(fault.field[i]);
    if (fault.field[i] == '[' && fault.index >= 0 && fault.index <= 9) {
      text.add(static_cast<char>('0' + fault.index));
    }
  }
}

}  // namespace

const char* describe(const BlockStatus& status, Span<char> text) {
  if (text.empty()) return "";
  Text line(text);
  line.add(summary(status.code));
  if (status.section[0] != '\0') {
    line.add(" \"");
    line.add(status.section);
    line.add('"');
  }
  if (status.fault.is_fault()) {
    line.add(": ");
    add_field(line, status.fault);
  }
  return text.data();
}

}  // namespace berth
