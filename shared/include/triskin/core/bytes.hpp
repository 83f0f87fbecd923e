// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace triskin {

using Bytes = std::span<const std::uint8_t>;

/// Writes into a fixed buffer. After an overflow `ok()` is false, and nothing more is written.
class ByteWriter {
 public:
  /// Starts at the beginning of `out`, which must outlive the writer.
  constexpr explicit ByteWriter(std::span<std::uint8_t> out) : out_(out) {}
  /// Appends one byte.
  constexpr void u8(std::uint8_t v) {
    if (size_ < out_.size())
      out_[size_++] = v;
    else
      ok_ = false;
  }
  /// Appends two bytes, little-endian.
  constexpr void le16(std::uint16_t v) { little(v, 2); }
  /// Appends four bytes, little-endian.
  constexpr void le32(std::uint32_t v) { little(v, 4); }
  /// Appends eight bytes, little-endian.
  constexpr void le64(std::uint64_t v) { little(v, 8); }
  /// Appends two bytes, big-endian.
  constexpr void be16(std::uint16_t v) { big(v, 2); }
  /// Appends four bytes, big-endian.
  constexpr void be32(std::uint32_t v) { big(v, 4); }
  /// Appends the bytes unchanged.
  constexpr void bytes(Bytes in) {
    for (const std::uint8_t b : in) u8(b);
  }
  /// Returns false once a value did not fit into the buffer.
  [[nodiscard]] constexpr bool ok() const { return ok_; }
  /// Counts the bytes written so far.
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  /// Returns the bytes written so far; the view is valid as long as the buffer.
  [[nodiscard]] constexpr Bytes written() const { return {out_.data(), size_}; }

 private:
  constexpr void little(std::uint64_t v, int n) {
    for (int k = 0; k < n; ++k) u8(static_cast<std::uint8_t>(v >> (8 * k)));
  }
  constexpr void big(std::uint64_t v, int n) {
    for (int k = n - 1; k >= 0; --k) u8(static_cast<std::uint8_t>(v >> (8 * k)));
  }
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

/// Reads from a span of bytes. Reading past the end gives 0 and makes `ok()` false.
class ByteReader {
 public:
  /// Starts at the beginning of `in`, whose bytes must outlive the reader.
  constexpr explicit ByteReader(Bytes in) : in_(in) {}
  /// Reads one byte; returns 0 past the end.
  constexpr std::uint8_t u8() {
    if (at_ < in_.size()) return in_[at_++];
    ok_ = false;
    return 0;
  }
  /// Reads two bytes, little-endian.
  constexpr std::uint16_t le16() { return static_cast<std::uint16_t>(little(2)); }
  /// Reads four bytes, little-endian.
  constexpr std::uint32_t le32() { return static_cast<std::uint32_t>(little(4)); }
  /// Reads eight bytes, little-endian.
  constexpr std::uint64_t le64() { return little(8); }
  /// Reads two bytes, big-endian.
  constexpr std::uint16_t be16() { return static_cast<std::uint16_t>(big(2)); }
  /// Reads four bytes, big-endian.
  constexpr std::uint32_t be32() { return static_cast<std::uint32_t>(big(4)); }
  /// Returns the bytes that have not been read yet, without consuming them.
  [[nodiscard]] constexpr Bytes rest() const { return in_.subspan(at_); }
  /// Returns false once a read went past the end.
  [[nodiscard]] constexpr bool ok() const { return ok_; }

 private:
  constexpr std::uint64_t little(int n) {
    std::uint64_t v = 0;
    for (int k = 0; k < n; ++k) v |= static_cast<std::uint64_t>(u8()) << (8 * k);
    return v;
  }
  constexpr std::uint64_t big(int n) {
    std::uint64_t v = 0;
    for (int k = 0; k < n; ++k) v = v << 8 | u8();
    return v;
  }
  Bytes in_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

/// The table has the effect of four bits on a CRC-32: four steps of the reflected polynomial 0xEDB88320.
inline constexpr auto kCrcOfNibble = [] {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t n = 0; n < table.size(); ++n) {
    table[n] = n;
    for (int k = 0; k < 4; ++k) table[n] = (table[n] >> 1) ^ (0xEDB88320U & (0U - (table[n] & 1U)));
  }
  return table;
}();

/// Computes the CRC-32 of ISO-HDLC (reflected 0xEDB88320, init and final xor all ones): "123456789" → 0xCBF43926. It
/// processes four bits per step, because the loader computes it over whole images before it starts one.
[[nodiscard]] constexpr std::uint32_t crc32(Bytes bytes, std::uint32_t seed = 0) {
  std::uint32_t crc = ~seed;
  for (const std::uint8_t b : bytes) {
    crc ^= b;
    crc = (crc >> 4) ^ kCrcOfNibble[crc & 15];
    crc = (crc >> 4) ^ kCrcOfNibble[crc & 15];
  }
  return ~crc;
}

}  // namespace triskin
