#include "app/parameter_block.hpp"

#include "app/crc32.hpp"
#include "app/parameter_fields.hpp"

namespace berth {
namespace {

constexpr std::uint8_t kMagic[4] = {'B', 'P', 'A', 'R'};
constexpr std::size_t kHeader_bytes = 12;
constexpr std::size_t kSectionHeader_bytes = 8;
constexpr std::size_t kCrc_bytes = 4;

using Bytes = Span<const std::uint8_t>;

std::uint32_t read_u32(Bytes bytes, std::size_t at) {
  return bytes[at] | (std::uint32_t{bytes[at + 1]} << 8) | (std::uint32_t{bytes[at + 2]} << 16) |
         (std::uint32_t{bytes[at + 3]} << 24);
}

std::uint32_t read_u16(Bytes bytes, std::size_t at) {
  return bytes[at] | (std::uint32_t{bytes[at + 1]} << 8);
}

/// Takes fields off a payload; past its end every field is zero and the length does not match.
class Reader {
 public:
  explicit Reader(Bytes payload) : payload_(payload) {}

  void operator()(std::int32_t& value) { value = static_cast<std::int32_t>(take()); }
  void operator()(bool& value) {
    const std::uint32_t word = take();
    value = word == 1;
    has_bad_flag_ = has_bad_flag_ || word > 1;
  }
  template <int F>
  void operator()(Q<F>& value) {
    value = Q<F>::from_raw(static_cast<std::int32_t>(take()));
  }

  bool took_exactly_all() const { return at_ == payload_.size(); }
  bool has_bad_flag() const { return has_bad_flag_; }

 private:
  std::uint32_t take() {
    const std::size_t from = at_;
    at_ += 4;
    return at_ <= payload_.size() ? read_u32(payload_, from) : 0;
  }

  Bytes payload_;
  std::size_t at_ = 0;
  bool has_bad_flag_ = false;
};

/// Appends to a span; past its end nothing is written and `fits` turns false.
class Writer {
 public:
  explicit Writer(Span<std::uint8_t> out) : out_(out) {}

  void byte(std::uint32_t value) {
    if (at_ < out_.size()) out_[at_] = static_cast<std::uint8_t>(value & 0xFFu);
    ++at_;
  }
  void u16(std::uint32_t value) { byte(value), byte(value >> 8); }
  void u32(std::uint32_t value) { u16(value), u16(value >> 16); }
  void operator()(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void operator()(bool value) { u32(value ? 1 : 0); }
  template <int F>
  void operator()(Q<F> value) {
    (*this)(value.raw());
  }

  bool fits() const { return at_ <= out_.size(); }
  std::size_t size() const { return at_; }
  Bytes written() const { return out_.first(at_); }

 private:
  Span<std::uint8_t> out_;
  std::size_t at_ = 0;
};

/// Counts what a writer would write.
class Sizer {
 public:
  template <typename Field>
  void operator()(const Field&) {
    size_ += 4;
  }
  std::uint32_t size() const { return size_; }

 private:
  std::uint32_t size_ = 0;
};

BlockStatus failure(BlockCode code) {
  BlockStatus status;
  status.code = code;
  return status;
}

BlockStatus section_failure(BlockCode code, const char* id) {
  BlockStatus status = failure(code);
  for (int i = 0; i < 4; ++i) status.section[i] = id[i];
  return status;
}

BlockStatus field_failure(FieldFault fault) {
  BlockStatus status = failure(BlockCode::kOutOfRange);
  status.fault = fault;
  return status;
}

BlockStatus check_envelope(Bytes bytes) {
  if (bytes.size() < kHeader_bytes + kCrc_bytes) return failure(BlockCode::kTooShort);
  for (std::size_t i = 0; i < 4; ++i) {
    if (bytes[i] != kMagic[i]) return failure(BlockCode::kMagic);
  }
  if (read_u32(bytes, 8) != bytes.size()) return failure(BlockCode::kLength);
  const std::size_t crc_at = bytes.size() - kCrc_bytes;
  if (crc32(bytes.first(crc_at)) != read_u32(bytes, crc_at)) return failure(BlockCode::kCrc);
  // Magic, length and CRC keep their places in every version, so that a damaged version number is
  // told from a new one.
  if (read_u16(bytes, 4) != kParameterBlockVersion) return failure(BlockCode::kVersion);
  return {};
}

/// Index of the section whose id stands at `at`, kSectionCount where none has it. `id` receives the
/// text for messages.
int find_section(Bytes bytes, std::size_t at, char (&id)[5]) {
  for (std::size_t i = 0; i < 4; ++i) {
    const char c = static_cast<char>(bytes[at + i]);
    id[i] = c >= ' ' && c <= '~' ? c : '?';
  }
  id[4] = '\0';
  for (int s = 0; s < kSectionCount; ++s) {
    bool is_same = true;
    for (std::size_t i = 0; i < 4; ++i) {
      is_same = is_same && bytes[at + i] == static_cast<std::uint8_t>(kSectionIds[s][i]);
    }
    if (is_same) return s;
  }
  return kSectionCount;
}

/// The one flag of a section that has any.
const char* flag_of(Section section) {
  return section == Section::kMode ? "mode.track" : "target.white_on_black";
}

BlockStatus decode_payload(int section, Bytes payload, Parameters& parameters) {
  Reader reader(payload);
  visit_section(reader, static_cast<Section>(section), parameters);
  const std::int32_t dots = parameters.target.dot_count;
  if (dots < 0 || dots > kMaxDots) return field_failure({"target.dot_count"});
  if (!reader.took_exactly_all()) {
    return section_failure(BlockCode::kSectionLength, kSectionIds[section]);
  }
  if (reader.has_bad_flag()) return field_failure({flag_of(static_cast<Section>(section))});
  return {};
}

BlockStatus decode_sections(Bytes bytes, std::uint32_t count, Parameters& parameters) {
  bool is_seen[kSectionCount] = {};
  std::size_t at = kHeader_bytes;
  const std::size_t end = bytes.size() - kCrc_bytes;
  // Each known section once and the first unknown one ends it: at most kSectionCount + 1 turns.
  for (std::uint32_t n = 0; n < count; ++n) {
    if (end - at < kSectionHeader_bytes) return failure(BlockCode::kLength);
    char id[5];
    const int section = find_section(bytes, at, id);
    if (section == kSectionCount) return section_failure(BlockCode::kUnknownSection, id);
    if (is_seen[section]) return section_failure(BlockCode::kDuplicateSection, id);
    is_seen[section] = true;
    const std::size_t length = read_u32(bytes, at + 4);
    at += kSectionHeader_bytes;
    if (length > end - at) return section_failure(BlockCode::kSectionLength, id);
    const BlockStatus status = decode_payload(section, bytes.subspan(at, length), parameters);
    if (!status.is_ok()) return status;
    at += length;
  }
  for (int s = 0; s < kSectionCount; ++s) {
    if (!is_seen[s]) return section_failure(BlockCode::kMissingSection, kSectionIds[s]);
  }
  return at == end ? BlockStatus{} : failure(BlockCode::kLength);
}

}  // namespace

BlockStatus decode_parameter_block(Span<const std::uint8_t> bytes, Parameters& out) {
  BlockStatus status = check_envelope(bytes);
  if (!status.is_ok()) return status;
  Parameters decoded;
  status = decode_sections(bytes, read_u16(bytes, 6), decoded);
  if (!status.is_ok()) return status;
  status = validate_parameters(decoded);
  if (status.is_ok()) out = decoded;
  return status;
}

std::size_t encode_parameter_block(const Parameters& parameters, Span<std::uint8_t> out) {
  if (parameters.target.dot_count < 0 || parameters.target.dot_count > kMaxDots) return 0;
  std::uint32_t payload[kSectionCount] = {};
  std::uint32_t total = kHeader_bytes + kCrc_bytes;
  for (int s = 0; s < kSectionCount; ++s) {
    Sizer sizer;
    visit_section(sizer, static_cast<Section>(s), parameters);
    payload[s] = sizer.size();
    total += static_cast<std::uint32_t>(kSectionHeader_bytes) + payload[s];
  }
  if (out.size() < total) return 0;
  Writer writer(out);
  for (const std::uint8_t c : kMagic) writer.byte(c);
  writer.u16(kParameterBlockVersion), writer.u16(kSectionCount), writer.u32(total);
  for (int s = 0; s < kSectionCount; ++s) {
    for (int i = 0; i < 4; ++i) writer.byte(static_cast<std::uint8_t>(kSectionIds[s][i]));
    writer.u32(payload[s]);
    visit_section(writer, static_cast<Section>(s), parameters);
  }
  writer.u32(crc32(writer.written()));
  return writer.size();
}

}  // namespace berth
