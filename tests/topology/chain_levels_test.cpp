// SPDX-License-Identifier: GPL-3.0-or-later
// The chain moves bytes while no bit can flip, which must give the same result as bit by bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "random_patch.hpp"

namespace triskin::test {
namespace {

constexpr double kNever = 1e-300;  // The value asks for single bits but flips none.

TEST(ChainLevels, bytes_and_bits_give_the_same) {
  std::mt19937_64 random(51);
  int exchanged = 0, broken = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const RandomPatch patch = random_patch(1 + trial % 16, trial % 5, random);
    SwitchedPatch bytes(patch.joints, patch.cable_port, 7), bits(patch.joints, patch.cable_port, 7);
    bits.set_bit_error_rate(kNever);
    bytes.enable(1);
    bits.enable(1);
    for (int step = 0; step < 60; ++step) {
      std::array<std::uint8_t, 19> out{}, a{}, b{};
      const std::size_t n = 1 + random() % out.size();
      for (std::uint8_t& byte : out) byte = static_cast<std::uint8_t>(random());
      bytes.exchange(Bytes(out).first(n), a);
      bits.exchange(Bytes(out).first(n), b);
      ASSERT_EQ(a, b) << "trial " << trial << " step " << step;
      exchanged += static_cast<int>(n);
      broken += std::all_of(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(n),
                            [](std::uint8_t v) { return v == 0xFF || v == 0; })
                    ? 1
                    : 0;
      if (random() % 4 == 0) {
        bytes.latch();
        bits.latch();
      }
      for (int m = 0; m < patch.size(); ++m)
        ASSERT_EQ(bytes.depth_of(layout::TableRow{m}), bits.depth_of(layout::TableRow{m}))
            << "trial " << trial << " step " << step;
    }
    EXPECT_DOUBLE_EQ(bytes.time_us(), bits.time_us());
  }
  EXPECT_GT(exchanged, 100'000);
  EXPECT_GT(broken, 100);  // Constants of refused and of empty ports were among them.
}

TEST(ChainLevels, flipped_bits_are_as_many_as_asked_for) {
  RandomPatch patch;
  patch.joints.resize(1);
  SwitchedPatch model(patch.joints, 0, 3);
  model.enable(1);
  model.set_bit_error_rate(0.01);
  std::array<std::uint8_t, 19> zeros{}, in{};
  int flipped = 0;
  for (int k = 0; k < 2000; ++k) {
    model.exchange(zeros, in);
    for (const std::uint8_t byte : in) flipped += std::popcount(byte);
  }
  EXPECT_NEAR(flipped, 2000 * 19 * 8 * 0.01, 5 * std::sqrt(2000 * 19 * 8 * 0.01));
}

}  // namespace
}  // namespace triskin::test
