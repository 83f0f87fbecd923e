// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the board for installed iCub patches (firmware/board/stm32g474/boards/icub_patch): other pins, a light that is
// on when its pin is low, no USB, and one clock wire for all lines.
#include "ramps.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::machine {
namespace {

class OneScl : public Ramps {
 protected:
  void SetUp() override {
    board = icub_patch_board();
    running_slot = 0;
    Bench::SetUp();
  }
  /// Returns the fraction of the conversions that arrived as samples; none of them may be torn.
  double share_read(std::uint64_t run_us) {
    frames.clear();
    run_for(run_us);
    double least = 1.0;
    const auto by_module = samples();
    EXPECT_EQ(by_module.size(), 16U);
    for (const auto& [m, list] : by_module)
      least = std::min(least, static_cast<double>(list.size()) * static_cast<double>(module_at(m).chip->sequence_us()) /
                                  static_cast<double>(run_us));
    return least;
  }
};

TEST_F(OneScl, FromTheFactoryFileToTheStream) {
  power_up();
  run_for(300'000);
  const auto hardware = request({0x22, 0xF1, 0x91});
  ASSERT_EQ(hardware.size(), 11U);
  EXPECT_EQ(hardware.back(), '2') << "an image for another board is refused";
  EXPECT_TRUE(confirmed());
  ASSERT_TRUE(flash_table(patch(16)));
  ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
  run_for(1'500'000);
  EXPECT_EQ(samples().size(), 16U);
  EXPECT_FALSE(machine->usb().attached());
  EXPECT_NE(machine->serial_text().find("started: firmware "), std::string::npos) << "the log is on PB3";
  expect_no_violation();
}

// A model with two masters on one wire reports a violation: this is what the other image does there.
TEST_F(OneScl, FourMastersOfTheirOwnWouldFight) {
  BenchBoard nucleo = nucleo_board();
  nucleo.pins.one_scl = true;
  board = nucleo;
  flash.program_file(nucleo.file("triskin_factory.hex"));
  store_table(patch(16));
  power_up();
  run_for(300'000);
  ASSERT_FALSE(machine->violations().empty());
  EXPECT_NE(machine->violations().front().what.find("same SCL"), std::string::npos);
}

// Sixteen modules need 16 × 0.64 = 10.3 ms of the one wire: more than a sequence of 9.2 ms, less than one of 18.4 ms.
TEST_F(OneScl, ReadsSixteenModulesWithoutATornSample) {
  spread_clocks(1.0);
  start(16, {wire::Decimation::k256, 1});
  run_for(500'000);  // Sixteen chips share the wire for their twelve and more configurations, too.
  const double read = share_read(4'000'000);
  for (const auto& [m, list] : samples()) {
    for (const wire::TaxelFrame& f : list) expect_not_torn(m, f);
  }
  std::printf("one SCL, 16 modules, 36.9 ms: the slowest gives %.1f %% of its sequences\n", 100 * read);
  EXPECT_GE(read, 0.5);
  expect_no_violation();
}

TEST_F(OneScl, ReadsByATimerAsInstalledBoardsDo) {
  spread_clocks(1.0);
  start(16, {wire::Decimation::k128, 1, wire::TaxelOutput::kRaw, wire::SamplingTiming::kTimer});
  const double read = share_read(3'000'000);
  std::printf("one SCL by a timer, 16 modules, 18.4 ms: the slowest gives %.1f %% of its sequences\n", 100 * read);
  EXPECT_GE(read, 0.9);
  expect_no_violation();
}

TEST_F(OneScl, AChipThatIsAbsentStopsNoOther) {
  module_at(5).present = false;
  start(16, {wire::Decimation::k256, 1});
  run_for(1'500'000);
  std::size_t working = 0;
  for (const auto& [m, list] : samples()) {
    if (m == 5) continue;
    ++working;
    EXPECT_GE(list.size(), 10U) << m;
  }
  EXPECT_EQ(working, 15U);
  expect_no_violation();
}

// The light is on at a low pin, for half of the time while it samples.
TEST_F(OneScl, LightIsOnWhenItsPinIsLow) {
  constexpr std::uint32_t kOutputsOfB = 0x48000414;
  store_table(patch(4));
  power_up();
  run_for(1'050'000);
  int on = 0;
  for (int k = 0; k < 50; ++k) {
    run_for(20'000);
    on += (machine->read_register(kOutputsOfB) & 1) == 0 ? 1 : 0;
  }
  EXPECT_NEAR(on, 25, 3);
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine
