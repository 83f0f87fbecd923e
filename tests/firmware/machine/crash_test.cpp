// SPDX-License-Identifier: GPL-3.0-or-later
// The image is made to fail: its remains must tell where, and a loop of crashes must end.
#include "crash_bench.hpp"

namespace triskin::machine {
namespace {

class Crashes : public CrashBench {};

TEST_F(Crashes, UndefinedInstructionIsNamedWithItsPlace) {
  start_work();
  overwrite(kUndefined, kUndefined);
  run_for(300'000);
  EXPECT_EQ(machine->counts().resets, 1);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kFault);
  EXPECT_EQ(c->pc & ~1U, address_of(kStep));
  EXPECT_EQ(c->fault_status, 1U << 16);
  EXPECT_EQ(c->number, 1U);
  EXPECT_EQ(c->origin, application.origin());
  EXPECT_GE(c->uptime_ms, 200U);
  EXPECT_EQ(health().value().crashes_in_row, 1);
  ASSERT_EQ(request({0x14, 0xFF, 0xFF, 0xFF}).at(0), 0x54);
  EXPECT_FALSE(crash().has_value()) << "cleared with the fault memory";
}

TEST_F(Crashes, AccessToNothingIsNamedWithItsAddress) {
  start_work();
  // The word points to the table of functions of the object.
  machine->write_word(address_of("_ZN7triskin5board3canE"), 0x60000000);
  run_for(300'000);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kFault);
  EXPECT_NE(c->pc, 0U);
  EXPECT_EQ(c->address & 0xFFFFFF00, 0x60000000U);
}

TEST_F(Crashes, LoopThatHangsIsNamedWithItsPlace) {
  start_work();
  overwrite(kForEver, kForEver);
  run_for(2'500'000);
  EXPECT_EQ(machine->counts().resets, 1);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kWatchdog);
  EXPECT_EQ(c->pc & ~1U, address_of(kStep));
  expect_no_violation();
}

// The code is cpsid i; b . – the interrupt before the watchdog never runs, so the place is unknown.
TEST_F(Crashes, LoopThatHangsWithInterruptsOffIsLeftToTheWatchdog) {
  start_work();
  overwrite(0xE7FEB672, kForEver);
  run_for(3'000'000);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kWatchdog);
  EXPECT_EQ(c->pc, 0U);
  EXPECT_NE(health().value().reset_cause & wire::reset_cause::kWatchdog, 0);
}

TEST_F(Crashes, StackOverflowIsNamedWithTheFunctionThatWentDeepest) {
  start_work();
  overwrite(kRecursion[0], kRecursion[1]);
  run_for(300'000);
  const auto c = crash();
  ASSERT_TRUE(c.has_value());
  EXPECT_EQ(c->cause, wire::CrashCause::kStackOverflow);
  EXPECT_LT(c->sp, 0x20000000U);
  EXPECT_EQ(c->lr & ~1U, address_of(kStep) + 6) << "behind the call";
}

// An image that crashes again and again is abandoned: there is no other one, so the loader waits for a host.
TEST_F(Crashes, LoopOfCrashesEndsInTheLoader) {
  start_work();
  int crashes = 0;
  for (; crashes < 12 && machine->vector_table() == application.origin(); ++crashes) {
    overwrite(kUndefined, kUndefined);
    run_for(200'000);
  }
  EXPECT_EQ(crashes, 5);
  run_for(40'000'000);
  EXPECT_EQ(machine->vector_table(), 0x08000000U) << "it stays";
  EXPECT_TRUE(machine->usb().attached()) << "as a DFU device, and listens on CAN";
  power_up();
  run_for(200'000);
  EXPECT_EQ(machine->vector_table(), application.origin()) << "power-up is a new beginning";
}

}  // namespace
}  // namespace triskin::machine
