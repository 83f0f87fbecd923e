// SPDX-License-Identifier: GPL-3.0-or-later
#include "update_bench.hpp"

namespace triskin::machine {
namespace {

TEST_F(Update, NewApplicationIsWrittenCommittedStartedAndConfirmed) {
  enter_loader();
  ASSERT_EQ(erase(1), 0);
  ASSERT_EQ(write_image(), 0);
  ASSERT_EQ(commit(), 0);
  boot();
  EXPECT_EQ(machine->vector_table(), kSlotB);
  EXPECT_FALSE(request({0x22, 0xFD, 0x00}).empty());
  run_for(2'500'000);
  for (int k = 0; k < 5; ++k) {  // A confirmed image starts any number of times.
    power_up();
    run_for(100'000);
    EXPECT_EQ(machine->vector_table(), kSlotB);
  }
  expect_no_violation();
}

TEST_F(Update, ApplicationThatNeverConfirmsIsGivenUpAfterThreeStarts) {
  enter_loader();
  ASSERT_EQ(erase(1), 0);
  ASSERT_EQ(write_image(), 0);
  ASSERT_EQ(commit(), 0);
  boot();
  for (int start = 2; start <= 3; ++start) {
    power_up();
    run_for(100'000);  // Power fails long before the image confirms itself.
    EXPECT_EQ(machine->vector_table(), kSlotB) << start;
  }
  power_up();
  run_for(100'000);
  EXPECT_EQ(machine->vector_table(), kSlotA);
}

TEST_F(Update, RefusesTheRunningSlotAWrongCrcAndAnImageForTheOtherSlot) {
  enter_loader();
  EXPECT_EQ(erase(0), static_cast<int>(Status::kWrongTarget));
  ASSERT_EQ(erase(1), 0);
  ASSERT_EQ(write_image(), 0);
  next[100] ^= 1;
  EXPECT_EQ(commit(), static_cast<int>(Status::kBadCrc));
  next = whole_blocks(application);
  ASSERT_EQ(erase(1), 0);
  ASSERT_EQ(write_image(), 0);
  EXPECT_EQ(commit(), static_cast<int>(Status::kWrongTarget));
  boot();
  EXPECT_EQ(machine->vector_table(), kSlotA);
}

}  // namespace
}  // namespace triskin::machine
