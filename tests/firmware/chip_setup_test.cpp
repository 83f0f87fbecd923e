// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/logic/sampling/chip_setup.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace triskin::fw {
namespace {

using Next = ChipSetup::Next;
using State = ChipSetup::State;
using Polarity = Ad7147::Polarity;

// What a chip gives, for electrodes of 9.92 pF: 31 steps of 1,311 counts cancel them, so that they rest at 0x8000.
enum class Gives {
  kId,           // its device id, 0x1472
  kOtherId,      // that of another revision, 0x1473
  kRest,         // twelve results at the input and with the offsets that were configured
  kFourFarther,  // the same with electrodes that have four steps more
  kTwoChips,     // the same at the other input; at the used one 0, 1,024 or 2,048 counts less, in turn
  kMiddleNew,    // in mid-sequence: the results that the configured offsets give
  kMiddleOld,    // in mid-sequence: the results of the sequence before
  kNothing,      // no answer, or a mark that was not written: what is known of it is forgotten
};

struct Step {
  Gives gives;
  Next next;
  State state;
};

struct Case {
  std::string name;
  std::vector<Step> steps;
};

ad7147::Results results_of(const Ad7147::Stages& stages, int electrode_steps) {
  ad7147::Results results{};
  for (std::size_t t = 0; t < results.size(); ++t) {
    const int above = 1311 * (electrode_steps - static_cast<int>(stages.offsets[t]));
    results[t] = static_cast<std::uint16_t>(0x8000 + (stages.polarity == Polarity::kPositive ? above : -above));
  }
  return results;
}

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class ChipSetupWay : public testing::TestWithParam<Case> {
 protected:
  // Hands the setup what the chip gives, and returns what comes next.
  Next hand(Gives gives) {
    switch (gives) {
      case Gives::kId:
        return setup_.on_identity(0x1472, place_);
      case Gives::kOtherId:
        return setup_.on_identity(0x1473, place_);
      case Gives::kMiddleNew:
        setup_.on_middle(results_of(setup_.stages(), 31));
        return Next::kConfigureOffsets;
      case Gives::kMiddleOld:
        setup_.on_middle(last_);
        return Next::kConfigureOffsets;
      case Gives::kNothing:
        setup_.forget_chip();
        setup_.find();
        return Next::kConfigure;
      case Gives::kRest:
      case Gives::kFourFarther:
      case Gives::kTwoChips:
        break;
    }
    last_ = results_of(setup_.stages(), gives == Gives::kFourFarther ? 35 : 31);
    if (gives == Gives::kTwoChips && setup_.stages().polarity == Polarity::kNegative) {
      for (std::size_t t = 0; t < last_.size(); ++t) last_[t] = static_cast<std::uint16_t>(last_[t] - 0x400 * (t % 3));
    }
    return setup_.on_results(last_, place_);
  }

  ChipSetup setup_;
  PlaceOffsets place_;
  ad7147::Results last_{};
};

TEST_P(ChipSetupWay, EachResultSaysWhatComesNext) {
  setup_.begin(false);
  int number = 0;
  for (const Step& step : GetParam().steps) {
    ASSERT_EQ(hand(step.gives), step.next) << "step " << number;
    ASSERT_EQ(setup_.state(), step.state) << "step " << number;
    ++number;
  }
}

using Steps = std::vector<Step>;

Steps joined(Steps first, const Steps& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

const Steps kFound{{Gives::kId, Next::kConfigure, State::kSearch}, {Gives::kRest, Next::kConfigure, State::kOther}};
// Two comparisons of both inputs.
const Steps kCompared{{Gives::kRest, Next::kConfigure, State::kUsed},
                      {Gives::kRest, Next::kConfigure, State::kOther},
                      {Gives::kRest, Next::kConfigure, State::kUsed}};
const Steps kLatching{
    {Gives::kRest, Next::kConfigure, State::kShifted},
    {Gives::kRest, Next::kConfigureOffsets, State::kLatching},
    {Gives::kMiddleNew, Next::kConfigureOffsets, State::kLatching},
    {Gives::kRest, Next::kSkip, State::kRun},
    {Gives::kRest, Next::kUse, State::kRun},
};

Steps first_time() {
  return joined(joined(kFound, kCompared), kLatching);
}

INSTANTIATE_TEST_SUITE_P(
    Table, ChipSetupWay,
    testing::Values(
        Case{"NewChip", first_time()},
        Case{"ElectrodesFourStepsFarther", joined(joined({{Gives::kId, Next::kConfigure, State::kSearch},
                                                          {Gives::kFourFarther, Next::kConfigure, State::kSearch},
                                                          {Gives::kFourFarther, Next::kConfigure, State::kOther}},
                                                         kCompared),
                                                  {{Gives::kFourFarther, Next::kConfigure, State::kShifted}})},
        // The search makes up for the 2,048 counts by two steps, which do not change what the other input lacks.
        Case{"TwoChips", joined(joined({{Gives::kId, Next::kConfigure, State::kSearch},
                                        {Gives::kTwoChips, Next::kConfigure, State::kSearch},
                                        {Gives::kTwoChips, Next::kConfigure, State::kOther},
                                        {Gives::kTwoChips, Next::kConfigure, State::kUsed},
                                        {Gives::kTwoChips, Next::kConfigure, State::kOther},
                                        {Gives::kTwoChips, Next::kConfigure, State::kUsed},
                                        {Gives::kTwoChips, Next::kConfigure, State::kOther},
                                        {Gives::kTwoChips, Next::kConfigure, State::kUsed},
                                        {Gives::kTwoChips, Next::kDuplicate, State::kFind}},
                                       kFound),  // One of them is taken away.
                                joined(kCompared, {{Gives::kRest, Next::kConfigure, State::kShifted}}))},
        Case{"AFingerBetweenTheReadings", joined(joined(kFound, {{Gives::kRest, Next::kConfigure, State::kUsed},
                                                                 {Gives::kTwoChips, Next::kConfigure, State::kOther}}),
                                                 joined(kCompared, kLatching))},
        Case{"NoReadingInMidSequence",  // Three attempts, then the usual way of latching is taken.
             joined(joined(kFound, kCompared), {{Gives::kRest, Next::kConfigure, State::kShifted},
                                                {Gives::kRest, Next::kConfigureOffsets, State::kLatching},
                                                {Gives::kRest, Next::kConfigureOffsets, State::kShifted},
                                                {Gives::kRest, Next::kConfigureOffsets, State::kLatching},
                                                {Gives::kRest, Next::kConfigureOffsets, State::kShifted},
                                                {Gives::kRest, Next::kConfigureOffsets, State::kLatching},
                                                {Gives::kRest, Next::kSkip, State::kRun}})},
        Case{"StuckLine",  // The chip is known to be single: its offsets are tried, and its readings count.
             joined(first_time(),
                    {{Gives::kId, Next::kConfigure, State::kSearch}, {Gives::kRest, Next::kUse, State::kRun}})},
        Case{"PowerDip",  // A second chip may have joined it.
             joined(joined(first_time(), joined({{Gives::kNothing, Next::kConfigure, State::kFind}}, kFound)),
                    joined(kCompared, {{Gives::kRest, Next::kConfigure, State::kSearch},
                                       {Gives::kRest, Next::kUse, State::kRun}}))},
        Case{"AnotherChip", joined(joined(first_time(), {{Gives::kOtherId, Next::kConfigure, State::kSearch},
                                                         {Gives::kRest, Next::kConfigure, State::kOther}}),
                                   joined(kCompared, {{Gives::kRest, Next::kConfigure, State::kSearch},
                                                      {Gives::kRest, Next::kUse, State::kRun}}))}),
    [](const testing::TestParamInfo<Case>& c) { return c.param.name; });

// Hands results for electrodes of 31 steps until the setup is in `state`.
void rest_until(ChipSetup& setup, PlaceOffsets& place, State state) {
  for (int reading = 0; reading < 8 && setup.state() != state; ++reading)
    (void)setup.on_results(results_of(setup.stages(), 31), place);
}

// The pads of installed iCub boards are on the positive input.
TEST(ChipSetup, ReadsTheOtherInputOnlyToTellOneChipFromTwo) {
  for (const bool positive : {false, true}) {
    ChipSetup setup;
    PlaceOffsets place;
    setup.begin(positive);
    const Polarity used = positive ? Polarity::kPositive : Polarity::kNegative;
    (void)setup.on_identity(0x1472, place);
    EXPECT_EQ(setup.stages().polarity, used);
    EXPECT_EQ(setup.stages().offsets[7], 31);
    rest_until(setup, place, State::kOther);
    EXPECT_NE(setup.stages().polarity, used);
    EXPECT_EQ(setup.stages().offsets[7], 24);
    rest_until(setup, place, State::kUsed);
    EXPECT_EQ(setup.stages().polarity, used);
    EXPECT_EQ(setup.stages().offsets[7], 24);
    rest_until(setup, place, State::kOther);
    EXPECT_EQ(setup.stages().offsets[7], 32);
    rest_until(setup, place, State::kShifted);
    EXPECT_EQ(setup.stages().polarity, used);
    EXPECT_EQ(setup.stages().offsets[7], 31);
  }
}

// A chip that joins after the comparison is without the mark, which no later configuration writes.
TEST(ChipSetup, MarksAChipBeforeItIsComparedAndNotAfter) {
  ChipSetup setup;
  PlaceOffsets place;
  setup.begin(false);
  for (int time = 0; time < 2; ++time) {
    (void)setup.on_identity(0x1472, place);
    EXPECT_EQ(setup.marks(), time == 0) << "the second time it is known to be single";
    for (int reading = 0; reading < 12 && !setup.runs(); ++reading) {
      (void)setup.on_results(results_of(setup.stages(), 31), place);
      EXPECT_FALSE(setup.marks());
    }
    ASSERT_TRUE(setup.runs());
    setup.find();
  }
  setup.forget_chip();
  (void)setup.on_identity(0x1472, place);
  EXPECT_TRUE(setup.marks());
}

// Four steps fewer in the first five stages: 27 of 31.
TEST(ChipSetup, ShiftsTheOffsetsOfTheFirstStagesToSeeWhenResultsChange) {
  ChipSetup setup;
  PlaceOffsets place;
  setup.begin(false);
  (void)setup.on_identity(0x1472, place);
  rest_until(setup, place, State::kShifted);
  ASSERT_EQ(setup.state(), State::kShifted);
  for (std::size_t s = 0; s < 12; ++s) EXPECT_EQ(setup.stages().offsets[s], s < 5 ? 27 : 31) << s;
  (void)setup.on_results(results_of(setup.stages(), 31), place);
  for (std::size_t s = 0; s < 12; ++s) EXPECT_EQ(setup.stages().offsets[s], 31) << s;
}

TEST(ChipSetup, TellsWhenAChipShowsItsResultsAndKeepsItsOffsets) {
  for (const bool at_end : {false, true}) {
    ChipSetup setup;
    PlaceOffsets place;
    setup.begin(false);
    (void)setup.on_identity(0x1472, place);
    rest_until(setup, place, State::kShifted);
    const ad7147::Results shifted = results_of(setup.stages(), 31);
    (void)setup.on_results(shifted, place);
    setup.on_middle(at_end ? shifted : results_of(setup.stages(), 31));
    EXPECT_FALSE(place.known);
    EXPECT_EQ(setup.on_results(results_of(setup.stages(), 31), place), Next::kSkip);
    EXPECT_EQ(setup.latching(), at_end ? wire::Latching::kEndOfSequence : wire::Latching::kEachStage);
    EXPECT_EQ(place.latching, setup.latching());
    EXPECT_TRUE(place.known && place.to_store);
    EXPECT_EQ(place.searches, 1U);
    EXPECT_EQ(place.steps[7], 31);
    EXPECT_EQ(place.state, wire::OffsetState::kFound);
  }
}

// Taxel 9 rests off the middle; at the positive input pressure raises the result, so it is turned round.
TEST(ChipSetup, SaysWhatEachTaxelReadWhenItsOffsetWasSettled) {
  for (const bool positive : {false, true}) {
    ChipSetup setup;
    PlaceOffsets place;
    setup.begin(positive);
    (void)setup.on_identity(0x1472, place);
    rest_until(setup, place, State::kLatching);
    EXPECT_EQ(place.rest, ad7147::Results{});
    setup.on_middle(results_of(setup.stages(), 31));
    ad7147::Results last = results_of(setup.stages(), 31);
    last[9] = 0x7123;
    ASSERT_EQ(setup.on_results(last, place), Next::kSkip);
    EXPECT_EQ(place.rest[9], positive ? 0x8EDC : 0x7123);
    (void)setup.on_identity(0x1472, place);
    EXPECT_EQ(place.rest, ad7147::Results{}) << "searched anew";
  }
}

// 18 steps more than the offsets that fitted before are 23,598 counts, more than the middle third of 10,922. Taken for
// steps of 1,122 counts they are 21; three steps too many stay within the middle third.
TEST(ChipSetup, AKnownChipWithOtherElectrodesGetsOtherOffsets) {
  ChipSetup setup;
  PlaceOffsets place;
  setup.begin(false);
  place.known = true;
  place.device_id = 0x1472;
  place.steps.fill(13);
  setup.take_up();
  setup.find();
  EXPECT_EQ(setup.on_identity(0x1472, place), Next::kConfigure);
  ASSERT_EQ(setup.state(), State::kSearch);
  EXPECT_EQ(setup.stages().offsets[0], 13);
  EXPECT_EQ(setup.on_results(results_of(setup.stages(), 31), place), Next::kConfigure);
  EXPECT_EQ(setup.stages().offsets[0], 13 + 21);
  EXPECT_EQ(setup.on_results(results_of(setup.stages(), 31), place), Next::kConfigureOffsets);
  EXPECT_EQ(setup.state(), State::kShifted);
}

// After a request to check everything a chip that ran is read at both inputs, and its way of latching is found anew.
TEST(ChipSetup, ForgetsWhatItWasToldToForget) {
  ChipSetup setup;
  PlaceOffsets place;
  setup.begin(false);
  setup.take_up();
  EXPECT_TRUE(setup.runs());
  setup.find();
  setup.forget_checks();
  place.known = true;
  place.device_id = 0x1472;
  place.steps.fill(31);
  EXPECT_EQ(setup.on_identity(0x1472, place), Next::kConfigure);
  EXPECT_EQ(setup.on_results(results_of(setup.stages(), 31), place), Next::kConfigure);
  EXPECT_EQ(setup.state(), State::kOther);
  rest_until(setup, place, State::kLatching);
  EXPECT_EQ(setup.state(), State::kLatching);
}

}  // namespace
}  // namespace triskin::fw
