// SPDX-License-Identifier: GPL-3.0-or-later
// The pages of the loader are write-protected on request, and everything else must work as before.
#include "sampling_bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kLoaderPages = 7U << 16, kNothing = 0x7F;

class LoaderProtection : public Sampling {
 protected:
  std::uint8_t protect(std::uint8_t on) {
    const auto answer = request({0x31, 0x01, 0x02, 0x07, on});
    return answer.size() == 5 && answer[0] == 0x71 ? answer[4] : 0xFF;
  }
};

TEST_F(LoaderProtection, CountsFromTheNextPowerUpAndCanBeReleased) {
  power_up();
  run_for(2'500'000);
  unlock();
  EXPECT_EQ(flash.write_protection, kNothing);
  EXPECT_EQ(protect(1), 0);
  EXPECT_EQ(flash.write_protection, kLoaderPages);
  EXPECT_EQ(health().value().findings & board::finding::kLoaderProtected, 0);
  power_up();
  run_for(2'500'000);
  EXPECT_NE(health().value().findings & board::finding::kLoaderProtected, 0);
  unlock();
  EXPECT_TRUE(flash_table(patch(4))) << "tables are written as before";
  EXPECT_EQ(protect(0), 0);
  EXPECT_EQ(flash.write_protection, kNothing);
  expect_no_violation();
}

TEST_F(LoaderProtection, IsRefusedWithoutTheKeyOrTooEarlyOrWithAnotherOption) {
  power_up();
  run_for(300'000);
  EXPECT_EQ(request({0x31, 0x01, 0x02, 0x07, 1}), (std::vector<std::uint8_t>{0x7F, 0x31, 0x7F}))
      << "in the default session";
  unlock();
  EXPECT_EQ(protect(1), static_cast<std::uint8_t>(Status::kFlashFailed)) << "the supply has not stood for two seconds";
  EXPECT_EQ(protect(2), static_cast<std::uint8_t>(Status::kOutOfRange));
  EXPECT_EQ(request({0x31, 0x01, 0x02, 0x07}).at(4), static_cast<std::uint8_t>(Status::kBadLength));
  EXPECT_EQ(flash.write_protection, kNothing);
  expect_no_violation();
}

TEST_F(LoaderProtection, IsRefusedOnAReadProtectedChip) {
  flash.options = (flash.options & ~0xFFU) | 0xBB;
  power_up();
  run_for(2'500'000);
  unlock();
  EXPECT_EQ(protect(1), static_cast<std::uint8_t>(Status::kFlashFailed));
  EXPECT_EQ(flash.write_protection, kNothing);
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
