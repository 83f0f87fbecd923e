// SPDX-License-Identifier: GPL-3.0-or-later
// Tests when and how a tare ends. Times and samples are worked by hand.
#include "triskin/skin/tare.hpp"

#include <gtest/gtest.h>

#include "support/strip_design.hpp"

namespace triskin::skin {
namespace {

using State = Tare::State;
constexpr double kRest = 30'000.0;

// Provides a cover of two modules that rest at kRest.
class Tares : public testing::Test {
 protected:
  void hear(int module, std::uint16_t valid = layout::kAllTaxels) {
    session::ModuleSample s;
    s.module = layout::ModuleId{module};
    s.sample.valid = valid;
    s.sample.value.fill(static_cast<std::uint16_t>(kRest));
    touches_.add(s);
    tare_.add(s);
  }
  void hear_often(int module) {
    for (std::size_t k = 0; k < TouchMap::kRestSamples; ++k) hear(module);
  }

  const design::Design design_ = test::strip(2);
  TouchMap touches_{design_};
  Tare tare_{touches_, 2};
};

TEST_F(Tares, end_when_each_taxel_has_three_samples) {
  EXPECT_EQ(tare_.step(0), State::kIdle);
  tare_.begin(1'000);
  EXPECT_EQ(tare_.step(2'000), State::kRunning);
  hear(0);
  hear(0);
  EXPECT_EQ(tare_.step(3'000), State::kRunning);
  hear(0);
  EXPECT_EQ(tare_.step(4'000), State::kDone);
  EXPECT_EQ(tare_.taxels(), 12U);
  EXPECT_DOUBLE_EQ(touches_.rest()[0][0], kRest);
}

TEST_F(Tares, wait_for_a_module_that_was_heard_before_it) {
  hear(1);
  tare_.begin(0);
  hear_often(0);
  EXPECT_EQ(tare_.step(Tare::kLimit_us - 1), State::kRunning);
  EXPECT_EQ(tare_.step(Tare::kLimit_us), State::kDone);
  EXPECT_EQ(tare_.taxels(), 12U);
}

TEST_F(Tares, are_incomplete_when_a_taxel_gave_two_samples_in_time) {
  tare_.begin(0);
  hear_often(0);
  hear(1);
  hear(1);
  EXPECT_EQ(tare_.step(Tare::kLimit_us), State::kIncomplete);
}

TEST_F(Tares, that_hear_nothing_valid_say_so) {
  tare_.begin(0);
  hear(0, 0);
  EXPECT_EQ(tare_.step(Tare::kLimit_us - 1), State::kRunning);
  EXPECT_EQ(tare_.step(Tare::kLimit_us), State::kNoSample);
  EXPECT_EQ(tare_.taxels(), 0U);
}

TEST_F(Tares, begin_anew_with_their_full_time) {
  tare_.begin(0);
  hear(0);
  tare_.begin(1'000'000);
  EXPECT_EQ(tare_.taxels(), 0U);
  EXPECT_EQ(tare_.step(Tare::kLimit_us), State::kRunning);
  EXPECT_EQ(tare_.step(1'000'000 + Tare::kLimit_us), State::kNoSample);
}

}  // namespace
}  // namespace triskin::skin
