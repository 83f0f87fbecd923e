// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace triskin {

using Bytes = std::span<const std::uint8_t>;

/// Writes into a fixed buffer; running over the end sets `ok()` to false and writes nothing more.
class ByteWriter {
 public:
  /// Writes to `out` from its beginning; `out` must outlive the writer.
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
  /// Appends bytes as they are.
  constexpr void bytes(Bytes in) {
    for (const std::uint8_t b : in) u8(b);
  }
  /// False once something found no room.
  [[nodiscard]] constexpr bool ok() const { return ok_; }
  /// Bytes written so far.
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  /// What was written so far; valid as long as the buffer.
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

/// Reads from bytes; reading over the end gives 0 and sets `ok()` to false.
class ByteReader {
 public:
  /// Reads `in` from its beginning; `in` must outlive the reader.
  constexpr explicit ByteReader(Bytes in) : in_(in) {}
  /// Takes one byte; 0 behind the end.
  constexpr std::uint8_t u8() {
    if (at_ < in_.size()) return in_[at_++];
    ok_ = false;
    return 0;
  }
  /// Takes two bytes, little-endian.
  constexpr std::uint16_t le16() { return static_cast<std::uint16_t>(little(2)); }
  /// Takes four bytes, little-endian.
  constexpr std::uint32_t le32() { return static_cast<std::uint32_t>(little(4)); }
  /// Takes eight bytes, little-endian.
  constexpr std::uint64_t le64() { return little(8); }
  /// Takes two bytes, big-endian.
  constexpr std::uint16_t be16() { return static_cast<std::uint16_t>(big(2)); }
  /// Takes four bytes, big-endian.
  constexpr std::uint32_t be32() { return static_cast<std::uint32_t>(big(4)); }
  /// Bytes not taken yet; taking none of them.
  [[nodiscard]] constexpr Bytes rest() const { return in_.subspan(at_); }
  /// False once something was taken from behind the end.
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

/// What four bits add to a CRC-32: the reflected polynomial 0xEDB88320, taken four times.
inline constexpr auto kCrcOfNibble = [] {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t n = 0; n < table.size(); ++n) {
    table[n] = n;
    for (int k = 0; k < 4; ++k) table[n] = (table[n] >> 1) ^ (0xEDB88320U & (0U - (table[n] & 1U)));
  }
  return table;
}();

/// CRC-32 of ISO-HDLC (reflected 0xEDB88320, init and final xor all ones): "123456789" → 0xCBF43926. Four bits at a
/// time: the loader takes it of whole images before it starts one.
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
