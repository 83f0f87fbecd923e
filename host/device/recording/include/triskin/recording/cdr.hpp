// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/core/bytes.hpp"

/// ROS 2 writes CDR in this way (OMG DDSI-RTPS 10.2, plain CDR version 1, little-endian): four bytes that name the
/// encoding, then the fields, each aligned to its size.
namespace triskin::recording {

/// Writes one message.
class CdrWriter {
 public:
  CdrWriter() : bytes_{0, 1, 0, 0} {}
  /// Appends one byte.
  void u8(std::uint8_t v) { bytes_.push_back(v); }
  /// Appends two bytes, aligned to a multiple of two.
  void u16(std::uint16_t v) { put(v, 2); }
  /// Appends four bytes, aligned to a multiple of four.
  void u32(std::uint32_t v) { put(v, 4); }
  /// Appends eight bytes, aligned to a multiple of eight.
  void u64(std::uint64_t v) { put(v, 8); }
  /// Appends a number of single precision, aligned like u32.
  void f32(float v) { put(std::bit_cast<std::uint32_t>(v), 4); }
  /// Appends a number of double precision, aligned like u64.
  void f64(double v) { put(std::bit_cast<std::uint64_t>(v), 8); }
  /// Appends a text: its length including the final 0, then the characters and the 0.
  void text(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  /// Appends the number of elements of a sequence, which must follow.
  void count(std::size_t n) { u32(static_cast<std::uint32_t>(n)); }
  /// Returns the message so far; it is valid until more is appended.
  [[nodiscard]] Bytes message() const { return bytes_; }

 private:
  static constexpr std::size_t kHead = 4;
  void put(std::uint64_t v, std::size_t n) {
    while ((bytes_.size() - kHead) % n != 0) bytes_.push_back(0);
    for (std::size_t k = 0; k < n; ++k) bytes_.push_back(static_cast<std::uint8_t>(v >> (8 * k)));
  }
  std::vector<std::uint8_t> bytes_;
};

/// Reads one message. Reading past the end gives 0 and makes ok() false.
class CdrReader {
 public:
  /// `message` must outlive the reader. ok() is false for another encoding.
  explicit CdrReader(Bytes message) : in_(message) { ok_ = in_.size() >= kHead && in_[0] == 0 && in_[1] == 1; }
  /// Reads one byte; like the following functions, it returns 0 past the end.
  std::uint8_t u8() { return static_cast<std::uint8_t>(take(1)); }
  /// Reads two bytes, aligned to a multiple of two.
  std::uint16_t u16() { return static_cast<std::uint16_t>(take(2)); }
  /// Reads four bytes, aligned to a multiple of four.
  std::uint32_t u32() { return static_cast<std::uint32_t>(take(4)); }
  /// Reads eight bytes, aligned to a multiple of eight.
  std::uint64_t u64() { return take(8); }
  /// Reads a number of single precision.
  float f32() { return std::bit_cast<float>(u32()); }
  /// Reads a number of double precision.
  double f64() { return std::bit_cast<double>(u64()); }
  /// Reads a text; returns an empty text when it is incomplete.
  std::string text() {
    const std::size_t n = count(1);
    std::string text(reinterpret_cast<const char*>(in_.data()) + at_, n == 0 ? 0 : n - 1);
    at_ += n;
    return text;
  }
  /// Reads the number of elements of a sequence whose elements take at least `min_bytes` each; returns 0 and makes ok()
  /// false when so many cannot follow.
  std::size_t count(std::size_t min_bytes) {
    const std::uint32_t n = u32();
    if (ok_ && n <= (in_.size() - at_) / min_bytes) return n;
    ok_ = false;
    return 0;
  }
  /// Returns true if all bytes were read.
  [[nodiscard]] bool at_end() const { return at_ >= in_.size(); }
  /// Returns false once a read went past the end, or when the encoding is another.
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  static constexpr std::size_t kHead = 4;
  std::uint64_t take(std::size_t n) {
    at_ += (n - (at_ - kHead) % n) % n;
    if (!ok_ || at_ + n > in_.size()) {
      ok_ = false;
      return 0;
    }
    std::uint64_t v = 0;
    for (std::size_t k = 0; k < n; ++k) v |= static_cast<std::uint64_t>(in_[at_++]) << (8 * k);
    return v;
  }
  Bytes in_;
  std::size_t at_ = kHead;
  bool ok_ = false;
};

}  // namespace triskin::recording
