// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/flash_memory.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "triskin/base/error.hpp"

namespace triskin::hardware {
namespace {

namespace fs = std::filesystem;
using Unit = std::array<std::uint8_t, 8>;
constexpr Unit kUnit{1, 2, 3, 4, 5, 6, 7, 8};

TEST(FlashMemory, refuses_what_the_silicon_refuses) {
  FlashMemory flash(4096);
  EXPECT_EQ(flash.bytes()[0], 0xFF);
  EXPECT_TRUE(flash.program(8, kUnit));
  EXPECT_EQ(flash.bytes()[8], 1);
  EXPECT_FALSE(flash.program(8, kUnit));   // A unit can be programmed once.
  EXPECT_FALSE(flash.program(12, kUnit));  // The address is not aligned.
  EXPECT_FALSE(flash.program(16, std::span(kUnit).first(4)));
  EXPECT_FALSE(flash.program(4096, kUnit));
  EXPECT_FALSE(flash.program(~std::size_t{7}, kUnit));
  EXPECT_FALSE(flash.erase_page(8));
  EXPECT_FALSE(flash.erase_page(4096));
  EXPECT_TRUE(flash.erase_page(0));
  EXPECT_EQ(flash.bytes()[8], 0xFF);
  EXPECT_TRUE(flash.program(8, kUnit));
}

TEST(FlashMemory, power_fails_in_the_operation_that_was_named) {
  std::array<std::uint8_t, 32> data{};
  FlashMemory flash(4096);
  flash.cut_power_after(2, FlashMemory::Tear::kHalf);
  EXPECT_THROW((void)flash.program(0, data), sim::PowerLost);
  // Two whole units are written, half of the third, and nothing of the fourth.
  EXPECT_EQ(std::count(flash.bytes().begin(), flash.bytes().end(), 0), 8 + 8 + 4);
  EXPECT_EQ(flash.operations(), 3U);
  EXPECT_TRUE(flash.program(64, data));  // The cut happens only once.
  flash.cut_power_after(0, FlashMemory::Tear::kBefore);
  EXPECT_THROW((void)flash.erase_page(0), sim::PowerLost);
  EXPECT_EQ(flash.bytes()[0], 0);
  flash.cut_power_after(0, FlashMemory::Tear::kHalf);
  EXPECT_THROW((void)flash.erase_page(0), sim::PowerLost);
  EXPECT_EQ(flash.bytes()[0], 0xFF);
}

TEST(FlashMemory, a_file_keeps_the_contents_and_is_used_by_one_process_at_a_time) {
  const fs::path file = fs::temp_directory_path() / ("flash_memory_test." + std::to_string(::getpid()));
  fs::remove(file);
  {
    FlashMemory flash(4096, file);
    EXPECT_TRUE(flash.program(2048, kUnit));
    EXPECT_THROW(FlashMemory(4096, file), DeviceError);
  }
  {
    FlashMemory again(4096, file);
    EXPECT_TRUE(std::equal(kUnit.begin(), kUnit.end(), again.bytes().begin() + 2048));
    EXPECT_FALSE(again.program(2048, kUnit));
    EXPECT_TRUE(again.erase_page(2048));
  }
  EXPECT_EQ(FlashMemory(4096, file).bytes()[2048], 0xFF);
  EXPECT_THROW(FlashMemory(8192, file), InputError);
  EXPECT_THROW(FlashMemory(8192, file / "x"), InputError);
  fs::remove(file);
}

}  // namespace
}  // namespace triskin::hardware
