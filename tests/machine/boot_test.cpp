// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench.hpp"
#include "triskin/board/budget.hpp"

namespace triskin::machine {
namespace {

TEST_F(Bench, LoaderStartsTheApplicationAt170MHz) {
  power_up();
  run_for(200'000);
  expect_no_violation();
  EXPECT_EQ(machine->sysclk_hz(), 170'000'000U);
  EXPECT_EQ(machine->vector_table(), 0x08004000U);
  EXPECT_GT(budget(offsetof(board::Budget, loops)), 1U);
  EXPECT_GT(machine->counts().idle_us, 100'000U);  // sleeps, does not spin
}

TEST_F(Bench, RunsOnWithoutACrystal) {
  crystal_works = false;
  power_up();
  run_for(400'000);
  EXPECT_EQ(machine->sysclk_hz(), 170'000'000U);
  EXPECT_EQ(machine->counts().resets, 0);
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  expect_no_violation();
}

TEST_F(Bench, AnswersUdsOnCan) {
  power_up();
  run_for(100'000);
  const auto hello = request({0x22, 0xFD, 0x00});
  ASSERT_GE(hello.size(), 26U);
  EXPECT_EQ(hello[0], 0x62);
  EXPECT_EQ(hello[12], 0x10);  // the first byte of the unique id
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
