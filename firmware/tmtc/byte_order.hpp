// Big-endian fields in and out of byte buffers: the byte order of every packet.
#pragma once

#include <cstdint>

#include "core/check.hpp"
#include "core/span.hpp"
#include "fixed/q.hpp"

namespace berth {

/// Appends fields to a buffer. A field that does not fit is dropped and noted; nothing is written
/// beyond the end.
class ByteWriter {
 public:
  explicit ByteWriter(Span<std::uint8_t> buffer) : buffer_(buffer) {}

  void u8(std::uint32_t value) { put(value, 1); }
  void u16(std::uint32_t value) { put(value, 2); }
  void u24(std::uint32_t value) { put(value, 3); }
  void u32(std::uint32_t value) { put(value, 4); }
  void u64(std::uint64_t value) {
    u32(static_cast<std::uint32_t>(value >> 32));
    u32(static_cast<std::uint32_t>(value));
  }
  /// Raw value, two's complement; the format is the field's own.
  template <int F>
  void q(Q<F> value) {
    u32(static_cast<std::uint32_t>(value.raw()));
  }

  bool has_overflowed() const { return overflowed_; }
  std::int32_t size() const { return size_; }
  Span<const std::uint8_t> written() const {
    return buffer_.first(static_cast<std::size_t>(size_));
  }

 private:
  void put(std::uint32_t value, int octets) {
    if (size_ + octets > static_cast<std::int32_t>(buffer_.size())) {
      overflowed_ = true;
      return;
    }
    for (int i = octets - 1; i >= 0; --i) {
      buffer_[static_cast<std::size_t>(size_++)] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }

  Span<std::uint8_t> buffer_;
  std::int32_t size_ = 0;
  bool overflowed_ = false;
};

/// Takes fields from a buffer. Past the end every field is zero and the shortage is noted.
class ByteReader {
 public:
  explicit ByteReader(Span<const std::uint8_t> buffer) : buffer_(buffer) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(take(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(take(2)); }
  std::uint32_t u24() { return take(3); }
  std::uint32_t u32() { return take(4); }
  std::uint64_t u64() {
    const std::uint64_t high = u32();
    return high << 32 | u32();
  }
  template <int F>
  void q(Q<F>& value) {
    value = Q<F>::from_raw(static_cast<std::int32_t>(u32()));
  }

  bool has_run_short() const { return short_; }
  std::int32_t remaining() const { return static_cast<std::int32_t>(buffer_.size()) - position_; }

 private:
  std::uint32_t take(int octets) {
    if (octets > remaining()) {
      short_ = true;
      position_ = static_cast<std::int32_t>(buffer_.size());
      return 0;
    }
    std::uint32_t value = 0;
    for (int i = 0; i < octets; ++i) {
      value = value << 8 | buffer_[static_cast<std::size_t>(position_++)];
    }
    return value;
  }

  Span<const std::uint8_t> buffer_;
  std::int32_t position_ = 0;
  bool short_ = false;
};

}  // namespace berth
