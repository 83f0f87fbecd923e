// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/can_bits.hpp"

#include <array>

namespace triskin::machine {
namespace {

constexpr std::array<std::uint8_t, 16> kSizes{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

/// Counts bits as they are sent, including stuff bits, and the CRC of a classic frame.
class Stuffer {
 public:
  void put(std::uint32_t value, int count) {
    for (int k = count - 1; k >= 0; --k) put_bit((value >> k & 1) != 0);
  }
  [[nodiscard]] std::uint32_t sent() const { return sent_; }
  /// Returns true if the last bit is a stuff bit.
  [[nodiscard]] bool ends_stuffed() const { return ends_stuffed_; }
  [[nodiscard]] std::uint32_t crc15() const { return crc_; }

 private:
  void put_bit(bool bit) {
    constexpr std::uint32_t kPolynomial = 0x4599;
    const bool next = bit != ((crc_ >> 14 & 1) != 0);
    crc_ = (crc_ << 1 & 0x7FFF) ^ (next ? kPolynomial : 0);
    count(bit);
    ends_stuffed_ = run_ == 5;
    if (ends_stuffed_) count(!bit);
  }
  void count(bool bit) {
    run_ = sent_ > 0 && bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    ++sent_;
  }
  std::uint32_t sent_ = 0, crc_ = 0;
  int run_ = 0;
  bool last_ = false, ends_stuffed_ = false;
};

std::uint32_t code_of(std::uint8_t size) {
  std::uint32_t code = 0;
  while (kSizes[code] < size) ++code;
  return code;
}

// Sends start bit and identifier, up to the bit that distinguishes classic from FD.
void put_identifier(Stuffer& out, const wire::CanFrame& f) {
  out.put(0, 1);
  if (!f.extended) {
    out.put(f.id, 11);
    out.put(0, 2);  // The bits are RTR or RRS, and IDE.
    return;
  }
  out.put(f.id >> 18, 11);
  out.put(3, 2);  // The bits are SRR and IDE.
  out.put(f.id & 0x3FFFF, 18);
  out.put(0, 1);  // The bit is RTR or RRS.
}

void put_data(Stuffer& out, const wire::CanFrame& f) {
  out.put(code_of(f.size), 4);
  for (std::uint32_t k = 0; k < f.size; ++k) out.put(f.data[k], 8);
}

}  // namespace

CanBits can_bits(const wire::CanFrame& frame) {
  // The frame ends with acknowledge and its delimiter, end of frame, interframe space.
  constexpr std::uint32_t kEnd = 2 + 7 + 3;
  Stuffer out;
  put_identifier(out, frame);
  if (!frame.fd) {
    out.put(0, frame.extended ? 2 : 1);  // The bits are r1 and r0.
    put_data(out, frame);
    out.put(out.crc15(), 15);
    return {out.sent() + 1 + kEnd, 0};
  }
  out.put(2, 2);  // The bits are FDF and res.
  out.put(frame.bit_rate_switch ? 1 : 0, 1);
  const std::uint32_t arbitration = out.sent();
  out.put(0, 1);  // The bit is ESI.
  put_data(out, frame);
  const std::uint32_t crc = frame.size > 16 ? 21 : 17;
  // The field has stuff count and CRC, with a stuff bit before each four bits.
  const std::uint32_t field = 4 + crc, fixed = 1 + field / 4;
  const std::uint32_t before =
      out.sent() - arbitration - (out.ends_stuffed() ? 1 : 0);  // The first fixed stuff bit replaces it.
  const std::uint32_t data = before + field + fixed + 1;
  return frame.bit_rate_switch ? CanBits{arbitration + kEnd, data} : CanBits{arbitration + kEnd + data, 0};
}

}  // namespace triskin::machine
