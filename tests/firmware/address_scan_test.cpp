// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/address_scan.hpp"

#include <gtest/gtest.h>

namespace triskin::fw {
namespace {

TEST(AddressScan, AsksTheFourAddressesInTurn) {
  AddressScan scan;
  EXPECT_FALSE(scan.requested());
  scan.request();
  EXPECT_TRUE(scan.requested());
  scan.begin();
  EXPECT_FALSE(scan.requested());
  for (std::uint8_t address = 0; address < 4; ++address) {
    EXPECT_EQ(scan.address(), address);
    EXPECT_FALSE(scan.result().done);
    EXPECT_EQ(scan.answered(Status::kBusError, Status::kOk), address < 3);
  }
  EXPECT_TRUE(scan.result().done);
  EXPECT_EQ(scan.result().answers, 0);
}

// There is a chip at 0, nothing at 1, another device at 2, a chip at 3: answers are 1 + 4 + 8, the wrong id is 4. An id
// that was read without an acknowledgement (address 1) has no meaning.
TEST(AddressScan, KeepsWhoAnsweredAndWhoIsNoConverter) {
  AddressScan scan;
  scan.request();
  scan.begin();
  EXPECT_TRUE(scan.answered(Status::kOk, Status::kOk));
  EXPECT_TRUE(scan.answered(Status::kBusError, Status::kWrongId));
  EXPECT_TRUE(scan.answered(Status::kOk, Status::kWrongId));
  EXPECT_FALSE(scan.answered(Status::kOk, Status::kOk));
  EXPECT_EQ(scan.result().answers, 0b1101);
  EXPECT_EQ(scan.result().wrong_id, 0b0100);
  EXPECT_FALSE(scan.result().stuck);
}

TEST(AddressScan, ANewRequestForgetsTheLastResult) {
  AddressScan scan;
  scan.begin();
  for (int k = 0; k < 4; ++k) (void)scan.answered(Status::kOk, Status::kWrongId);
  scan.request();
  EXPECT_FALSE(scan.result().done);
  EXPECT_EQ(scan.result().answers, 0);
  EXPECT_EQ(scan.result().wrong_id, 0);
}

TEST(AddressScan, BeginsAgainAfterAnInterruption) {
  AddressScan scan;
  scan.request();
  scan.begin();
  EXPECT_TRUE(scan.answered(Status::kOk, Status::kOk));
  scan.interrupt();
  EXPECT_TRUE(scan.requested());
  scan.begin();
  EXPECT_EQ(scan.address(), 0);
}

TEST(AddressScan, BeginsAgainOnALineThatWasFreed) {
  AddressScan scan;
  scan.begin();
  EXPECT_TRUE(scan.answered(Status::kOk, Status::kOk));
  scan.line_stuck(true);
  EXPECT_TRUE(scan.requested());
  EXPECT_EQ(scan.result().answers, 0);
  EXPECT_FALSE(scan.result().done);
}

TEST(AddressScan, EndsOnALineThatStaysStuck) {
  AddressScan scan;
  scan.begin();
  EXPECT_TRUE(scan.answered(Status::kOk, Status::kOk));
  scan.line_stuck(false);
  EXPECT_FALSE(scan.requested());
  EXPECT_TRUE(scan.result().done);
  EXPECT_TRUE(scan.result().stuck);
  EXPECT_EQ(scan.result().answers, 0b0001);
}

}  // namespace
}  // namespace triskin::fw
