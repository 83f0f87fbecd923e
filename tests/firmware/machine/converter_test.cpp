// SPDX-License-Identifier: GPL-3.0-or-later
// Tests real electrodes and cases that the data sheet of the converter leaves open: the image must find the offset of
// every stage, keep it, find it anew for another chip, and detect by itself when a chip shows its results.
#include <algorithm>
#include <cmath>

#include "behaviours.hpp"
#include "sampling_bench.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::machine {
namespace {

using wire::Latching;
using wire::ModuleState;
using wire::OffsetState;

class Converter : public Sampling, public ::testing::WithParamInterface<NamedBehaviour> {
 protected:
  void begin(unsigned seed, bool positive_input = false) {
    behave(GetParam().chip);
    for (int m = 0; m < layout::kMaxModules; ++m)
      SkinLine::solder_electrodes(module_at(m), seed + static_cast<unsigned>(m));
    layout::PatchImage image = patch(layout::kMaxModules);
    image.positive_input = positive_input;
    store_table(image);
    power_up();
  }
  void stream() {
    unlock();
    ASSERT_EQ(request({0x2E, 0xFD, 0x05, 0x02}).at(0), 0x6E);
    frames.clear();
  }
  wire::Offsets offsets() {
    const auto answer = request({0x22, 0xFD, 0x0B});
    EXPECT_GT(answer.size(), 3U);
    return wire::Offsets::decode(Bytes(answer).subspan(3)).value();
  }
  // Tests every taxel of every module in its last sample.
  void expect_all_in_the_middle_third() {
    run_for(200'000);
    const auto by_module = samples();
    ASSERT_EQ(by_module.size(), 16U);
    for (const auto& [m, list] : by_module) {
      EXPECT_EQ(list.back().state, ModuleState::kOk) << m;
      EXPECT_EQ(list.back().valid, layout::kAllTaxels) << m;
      for (const std::uint16_t v : list.back().value) {
        EXPECT_GE(v, 21'846) << m;
        EXPECT_LE(v, 43'690) << m;
      }
    }
  }
  void expect_states(OffsetState state) {
    const Latching latching = GetParam().chip.latched_at_end ? Latching::kEndOfSequence : Latching::kEachStage;
    const wire::Offsets o = offsets();
    ASSERT_EQ(o.count, 16);
    for (std::size_t m = 0; m < 16; ++m) {
      EXPECT_EQ(o.modules[m].state, state) << m;
      EXPECT_EQ(o.modules[m].outside, 0) << m;
      EXPECT_EQ(o.modules[m].latching, latching) << m;
    }
  }
};

TEST_P(Converter, ElectrodesOf2To18PfRestInTheMiddleThirdWithin2s) {
  begin(100);
  run_for(1'700'000);
  stream();
  expect_all_in_the_middle_third();
  EXPECT_LE(now_us(), 2'000'000U);
  expect_states(OffsetState::kFound);
  EXPECT_EQ(offsets().searches, 16U);
  expect_no_violation();
}

TEST_P(Converter, OffsetsAreKeptAndAnExchangedChipGetsItsOwn) {
  begin(200);
  run_for(1'500'000);
  power_up();  // The flash stays the same.
  run_for(700'000);
  expect_states(OffsetState::kKept);
  EXPECT_EQ(offsets().searches, 0U);
  stream();
  expect_all_in_the_middle_third();
  // One chip is exchanged while it runs, another without power.
  module_at(5).present = false;
  run_for(300'000);
  SkinLine::solder_electrodes(module_at(5), 900);
  SkinLine::exchange(module_at(5), hardware::Ad7147::kDeviceId, 5);
  module_at(5).present = true;
  run_for(1'000'000);
  expect_all_in_the_middle_third();
  EXPECT_EQ(offsets().modules[5].state, OffsetState::kFound);
  EXPECT_EQ(offsets().searches, 1U);
  SkinLine::solder_electrodes(module_at(9), 901);
  SkinLine::exchange(module_at(9), hardware::Ad7147::kDeviceId, 9);
  power_up();
  run_for(1'500'000);
  stream();
  expect_all_in_the_middle_third();
  EXPECT_EQ(offsets().searches, 1U);
  EXPECT_EQ(offsets().modules[9].state, OffsetState::kFound);
  EXPECT_EQ(offsets().modules[5].state, OffsetState::kKept);
}

// The unplugged chip is replaced so fast that nobody misses it, but its configuration is lost.
TEST_P(Converter, AChipThatIsExchangedUnseenGetsItsOwnToo) {
  begin(300);
  run_for(1'500'000);
  SkinLine::solder_electrodes(module_at(2), 902);
  SkinLine::exchange(module_at(2), hardware::Ad7147::kDeviceId, 2);
  run_for(1'500'000);
  stream();
  expect_all_in_the_middle_third();
}

TEST_P(Converter, RoutineSearchesThemAnew) {
  begin(400);
  run_for(1'500'000);
  unlock();
  ASSERT_EQ(request({0x31, 0x01, 0x02, 0x06}), (std::vector<std::uint8_t>{0x71, 0x01, 0x02, 0x06}));
  EXPECT_EQ(request({0x31, 0x03, 0x02, 0x06}).at(4), 0);
  run_for(1'000'000);
  EXPECT_EQ(request({0x31, 0x03, 0x02, 0x06}), (std::vector<std::uint8_t>{0x71, 0x03, 0x02, 0x06, 1}));
  EXPECT_EQ(offsets().searches, 32U);
}

// The installed iCub boards have the electrodes at the positive input, too: the code is inverted, so that pressure
// lowers the values that hosts see.
TEST_P(Converter, PositiveInputIsTurnedRound) {
  begin(500, true);
  run_for(1'500'000);
  EXPECT_TRUE(offsets().positive_input);
  EXPECT_EQ(module_at(0).chip->read_register(0x082, now_us()) & 0xFF, 0);  // This is the offset of the positive input.
  stream();
  expect_all_in_the_middle_third();
  const int before = samples().at(3).back().value[4];
  module_at(3).source.level[4] += 500;
  run_for(100'000);
  EXPECT_NEAR(samples().at(3).back().value[4], before - 500, 12);
}

TEST_P(Converter, TwoChipsAtOneAddressAreToldApartWithEveryElectrode) {
  begin(600);
  run_for(1'500'000);
  stream();
  module_at(4).address = 0;  // The address is that of module 0.
  self_test();
  run_for(1'500'000);
  frames.clear();
  run_for(1'500'000);
  EXPECT_GT(std::ranges::count(samples().at(0), ModuleState::kDuplicate, &wire::TaxelFrame::state), 0);
  EXPECT_EQ(std::ranges::count(samples().at(0), ModuleState::kOk, &wire::TaxelFrame::state), 0);
  module_at(4).address = 1;
  self_test();
  run_for(2'500'000);
  frames.clear();
  expect_all_in_the_middle_third();
}

INSTANTIATE_TEST_SUITE_P(Behaviours, Converter, ::testing::ValuesIn(kBehaviours),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace triskin::machine
