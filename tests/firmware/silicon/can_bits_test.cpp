// SPDX-License-Identifier: GPL-3.0-or-later
// Compares lengths of CAN frames, including stuff bits, with counts by hand.
#include "triskin/machine/can_bits.hpp"

#include <gtest/gtest.h>

namespace triskin::machine {
namespace {

// With 19 zeros and a CRC of zero, 34 equal bits get a stuff bit after each five; 13 bits follow.
TEST(CanBits, AFrameOfZerosHasSixStuffBits) {
  wire::CanFrame f;
  EXPECT_EQ(can_bits(f).nominal, 34U + 6U + 13U);
  EXPECT_EQ(can_bits(f).data, 0U);
}

// The bits 0 101 0101 0101 0 0 0 0010 10101010 10101010 have two runs of three, and none of five up to the CRC.
TEST(CanBits, BitsThatAlternateNeedNone) {
  wire::CanFrame f;
  f.id = 0x555;
  f.size = 2;
  f.data = {0xAA, 0xAA};
  const std::uint32_t bits = can_bits(f).nominal;
  EXPECT_GE(bits, 34U + 16U + 13U);
  EXPECT_LE(bits, 34U + 16U + 13U + 2U);  // The CRC may have up to two stuff bits.
}

// The FD frame has an 11-bit identifier of alternating bits, a switched rate and no data. Arbitration: 17 bits, none
// stuffed (0 10101010101 0 0 1 0 1), 12 at the end. Data: ESI, DLC 0000 after a 1: five zeros, whose stuff bit is the
// first fixed one; stuff count and CRC of 21 bits with 6 fixed stuff bits; CRC delimiter.
TEST(CanBits, AnFdFrameHasFixedStuffBitsInItsCrc) {
  wire::CanFrame f;
  f.id = 0x555;
  f.fd = f.bit_rate_switch = true;
  EXPECT_EQ(can_bits(f).nominal, 17U + 12U);
  EXPECT_EQ(can_bits(f).data, 5U + 21U + 6U + 1U);
  f.bit_rate_switch = false;  // BRS is a zero, too, so there are seven in a row, and the stuff bit follows the fifth.
  EXPECT_EQ(can_bits(f).data, 0U);
  EXPECT_EQ(can_bits(f).nominal, 17U + 12U + 5U + 1U + 21U + 6U + 1U);
}

TEST(CanBits, NoFrameIsLongerThanTheWorstCase) {
  for (unsigned n = 0; n < 2000; ++n) {
    wire::CanFrame f;
    f.extended = n % 2 == 0;
    f.id = f.extended ? n * 7919 & 0x1FFFFFFF : n * 13 & 0x7FF;
    f.size = static_cast<std::uint8_t>(n % 9);
    for (unsigned k = 0; k < 8; ++k) f.data[k] = static_cast<std::uint8_t>(n % 5 == 0 ? 0 : n * (k + 3));
    const std::uint32_t stuffed = (f.extended ? 54U : 34U) + 8U * f.size;
    EXPECT_GE(can_bits(f).nominal, stuffed + 13U);
    EXPECT_LE(can_bits(f).nominal, stuffed + (stuffed - 1) / 4 + 13U);
  }
}

}  // namespace
}  // namespace triskin::machine
