// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/time_budget.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "triskin/base/error.hpp"

namespace triskin::pipeline {
namespace {

// The test moves this clock.
class TimeBudgetTest : public testing::Test {
 protected:
  void wait(double seconds) { now_s_ += seconds; }

  double now_s_ = 1000.0;
  TimeBudget budget_{20.0, [this] { return now_s_; }};
};

TEST_F(TimeBudgetTest, a_step_is_granted_its_share_of_what_is_left) {
  wait(4.0);
  budget_.run("a", 0.25, [&](double end_s) { EXPECT_DOUBLE_EQ(end_s, 4.0 + 0.25 * 16.0); });
}

TEST_F(TimeBudgetTest, what_a_step_does_not_use_is_there_for_the_next) {
  budget_.run("a", 0.5, [&](double) { wait(1.0); });
  EXPECT_DOUBLE_EQ(budget_.run("b", 1.0, [](double end_s) { return end_s; }), 20.0);
  EXPECT_DOUBLE_EQ(budget_.left_s(), 19.0);
}

TEST_F(TimeBudgetTest, reserved_time_is_kept_until_its_step_begins) {
  budget_.reserve("wiring", 5.0);
  budget_.reserve("pricing", 2.0);
  budget_.reserve("wiring", 3.0);  // It was measured again, and replaces the 5 s.
  EXPECT_DOUBLE_EQ(budget_.left_s(), 15.0);
  budget_.run("growth", 1.0, [&](double end_s) { EXPECT_DOUBLE_EQ(end_s, 15.0), wait(15.0); });
  budget_.run("pricing", 1.0, [&](double end_s) { EXPECT_DOUBLE_EQ(end_s, 17.0), wait(1.0); });
  budget_.run("wiring", 1.0, [&](double end_s) { EXPECT_DOUBLE_EQ(end_s, 20.0); });
}

TEST_F(TimeBudgetTest, a_step_that_begins_late_is_granted_nothing) {
  wait(30.0);
  EXPECT_DOUBLE_EQ(budget_.run("late", 1.0, [](double end_s) { return end_s; }), 30.0);
  EXPECT_LT(budget_.left_s(), 0.0);
}

TEST_F(TimeBudgetTest, tells_what_each_step_took_also_of_one_that_throws) {
  budget_.run("a", 0.5, [&](double) { wait(2.0); });
  const auto failing = [&](double) {
    wait(3.0);
    throw std::runtime_error("no surface");
  };
  EXPECT_THROW(budget_.run("b", 1.0, failing), std::runtime_error);
  ASSERT_EQ(budget_.steps().size(), 2U);
  EXPECT_EQ(budget_.steps()[0].name, "a");
  EXPECT_DOUBLE_EQ(budget_.steps()[0].granted_s, 10.0);
  EXPECT_DOUBLE_EQ(budget_.steps()[0].used_s, 2.0);
  EXPECT_EQ(budget_.steps()[1].name, "b");
  EXPECT_DOUBLE_EQ(budget_.steps()[1].used_s, 3.0);
}

TEST_F(TimeBudgetTest, a_deadline_is_over_after_its_time) {
  wait(1.0);
  const auto is_over = budget_.is_over(3.0);
  EXPECT_FALSE(is_over());
  wait(1.9);
  EXPECT_FALSE(is_over());
  wait(0.2);
  EXPECT_TRUE(is_over());
}

TEST(TimeBudgetLimit, must_be_positive) {
  EXPECT_THROW(TimeBudget(0.0), InputError);
  EXPECT_THROW(TimeBudget(-1.0), InputError);
  EXPECT_THROW(TimeBudget{std::numeric_limits<double>::quiet_NaN()}, InputError);
}

}  // namespace
}  // namespace triskin::pipeline
