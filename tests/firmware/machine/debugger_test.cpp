// SPDX-License-Identifier: GPL-3.0-or-later
// A debugger that holds the core longer than the watchdog waits must find the program where it held it.
#include "bench.hpp"

namespace triskin::machine {
namespace {

class Debugger : public Bench, public ::testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    if (std::string_view(GetParam()) == "l452") {
      board = nucleo_l452re_board();
      running_slot = 0;
    }
    Bench::SetUp();
  }
};

TEST_P(Debugger, HoldsTheCoreForAMinuteWithoutAReset) {
  power_up();
  run_for(500'000);
  const int resets = machine->counts().resets;
  const std::uint32_t loops = budget(0);
  machine->hold_core(true);
  run_for(60'000'000);
  EXPECT_EQ(budget(0), loops) << "the core was held";
  EXPECT_EQ(machine->counts().resets, resets);
  machine->hold_core(false);
  run_for(500'000);
  EXPECT_EQ(machine->counts().resets, resets);
}

// The same without the bits that the firmware sets in DBGMCU_APB1FZR1.
TEST_P(Debugger, WithoutTheBitsTheWatchdogResets) {
  power_up();
  run_for(500'000);
  const int resets = machine->counts().resets;
  machine->write_register(0xE0042008, 0);
  machine->hold_core(true);
  run_for(2'500'000);
  EXPECT_EQ(machine->counts().resets, resets + 1);
}

INSTANTIATE_TEST_SUITE_P(Chips, Debugger, ::testing::Values("g474", "l452"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace triskin::machine
