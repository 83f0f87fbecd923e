// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/scene_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"

namespace triskin::scenario {
namespace {

using hardware::Expectation;
using Kind = Expectation::Kind;
using testing::HasSubstr;
constexpr std::uint64_t kSecond = 1'000'000;

Expectation expect(Kind kind, int module, std::uint64_t from_us, double bound = 0.0) {
  Expectation e;
  e.kind = kind;
  e.module = layout::ModuleId{module};
  e.from_us = from_us;
  e.bound = bound;
  return e;
}

// A palm of 30 N presses module 4 of a strip of six modules from 2 s until 3 s.
hardware::Scene touched() {
  hardware::Scene scene;
  scene.design = test::strip(6);
  hardware::Contact palm;
  palm.from_us = 2 * kSecond;
  palm.until_us = 3 * kSecond;
  palm.position_mm = hardware::center_of(scene.design, layout::ModuleId{4});
  palm.radius_mm = 20.0;
  palm.force_n = 30.0;
  scene.contacts = {palm};
  return scene;
}

TEST(SceneCheck, says_of_each_expectation_whether_it_held) {
  hardware::Scene scene = touched();
  scene.expectations = {
      expect(Kind::kNotPressed, 4, 1'500'000),        expect(Kind::kPressed, 4, 2'500'000),
      expect(Kind::kForceAbove, 4, 2'500'000, 1.0),   expect(Kind::kForceAbove, 4, 2'500'000, 100.0),
      expect(Kind::kForceAbove, -1, 2'500'000, 10.0), expect(Kind::kPressed, 0, 2'500'000),
      expect(Kind::kNotPressed, 4, 3'500'000),        expect(Kind::kState, 4, 1'500'000),
  };
  const SceneCheck check = check_scene(scene);
  ASSERT_EQ(check.results.size(), 8U);
  const std::vector<bool> expected{true, true, true, false, true, false, true, true};
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_EQ(check.results[k].held, expected[k])
        << hardware::text_of(scene.expectations[k]) << ": " << check.results[k].seen;
  EXPECT_EQ(check.failed(), 2U);
  EXPECT_THAT(check.results[3].seen, HasSubstr(" N, not as expected from 2.5"));
  EXPECT_EQ(check.results[1].samples, 1U);
}

TEST(SceneCheck, a_chip_that_falls_off_and_comes_back_is_reported) {
  hardware::Scene scene = touched();
  hardware::Fault loose;
  loose.kind = hardware::FaultKind::kRemovedChip;
  loose.module = layout::ModuleId{1};
  loose.from_us = 2 * kSecond;
  loose.until_us = 3 * kSecond;
  scene.faults = {loose};
  Expectation gone = expect(Kind::kState, 1, 2'200'000), back = expect(Kind::kState, 1, 3 * kSecond);
  gone.state = wire::ModuleState::kAbsent;
  gone.until_us = 2'900'000;
  gone.once = true;
  back.until_us = 9 * kSecond;
  back.once = true;
  scene.expectations = {expect(Kind::kState, 1, 1'500'000), gone, back};
  const SceneCheck check = check_scene(scene);
  for (const ExpectationResult& r : check.results) EXPECT_TRUE(r.held) << hardware::text_of(r.expectation) << r.seen;
}

TEST(SceneCheck, equal_scenes_report_equal_numbers) {
  hardware::Scene scene = touched();
  scene.effects.noise_counts = 3.0;
  Expectation e = expect(Kind::kForceAbove, 4, 2'200'000, 0.0);
  e.until_us = 2'800'000;
  scene.expectations = {e};
  const SceneCheck first = check_scene(scene), second = check_scene(scene);
  EXPECT_GT(first.results[0].samples, 5U);
  EXPECT_EQ(first.results[0].seen, second.results[0].seen);
}

TEST(SceneCheck, a_scene_that_expects_nothing_is_refused) {
  EXPECT_THROW((void)check_scene(touched()), InputError);
}

}  // namespace
}  // namespace triskin::scenario
