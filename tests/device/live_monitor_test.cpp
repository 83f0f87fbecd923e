// SPDX-License-Identifier: GPL-3.0-or-later
// What live knows and shows: rest values, contacts that are there from the start, the picture of a patch.
#include "triskin/skin/live_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/strip_design.hpp"

namespace triskin::device {
namespace {

using test::strip;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kPad = 3;

// A sample of a module that rests at `rest`, with one taxel `pressure` counts below.
ModuleSample frame(int module, double rest, double pressure) {
  ModuleSample f;
  f.module = module;
  f.sample.valid = layout::kAllTaxels;
  f.sample.state = wire::ModuleState::kOk;
  f.sample.value.fill(static_cast<std::uint16_t>(rest));
  f.sample.value[kPad] = static_cast<std::uint16_t>(rest - pressure);
  return f;
}

void feed(TouchMap& map, const ModuleSample& f) {
  for (std::size_t k = 0; k < TouchMap::kRestSamples; ++k) map.add(f);
}

TEST(TouchMap, a_contact_that_is_there_at_the_start_is_shown) {
  const design::Design design = strip(2);
  TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_EQ(map.pressed()[0].taxel, kPad);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 4'000);
  feed(map, frame(0, layout::kRestCounts, 0));
  EXPECT_TRUE(map.pressed().empty());
}

// The taxel rests 700 counts below the middle, which nobody could know while something lay on it.
TEST(TouchMap, a_contact_that_is_there_at_the_start_ends_without_a_ghost) {
  const design::Design design = strip(2);
  TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts - 700, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  map.add(frame(0, layout::kRestCounts - 700, 500));  // it is being lifted
  feed(map, frame(0, layout::kRestCounts - 700, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(0, layout::kRestCounts - 700, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 4'000);
}

TEST(TouchMap, modules_that_rest_beside_the_design_are_not_pressed) {
  const design::Design design = strip(2);
  TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts - 900, 0));
  feed(map, frame(1, layout::kRestCounts + 900, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(0, layout::kRestCounts + 8'000, 0));  // a finger that the controller took for rest has gone
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(1, layout::kRestCounts + 900, 250));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 250);
}

TEST(TouchMap, a_light_touch_within_the_band_ends_without_a_ghost) {
  const design::Design design = strip(2);
  TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts, 500));
  feed(map, frame(0, layout::kRestCounts, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(0, layout::kRestCounts, 500));
  EXPECT_EQ(map.pressed().size(), 1U);
}

TEST(TouchMap, a_tare_holds_whatever_the_rest_is_and_can_be_kept) {
  const design::Design design = strip(2);
  TouchMap map(design);
  feed(map, frame(0, 20'000, 0));
  EXPECT_EQ(map.pressed().size(), static_cast<std::size_t>(layout::kPressureTaxelsPerModule));
  map.tare();
  map.add(frame(0, 20'000, 0));
  EXPECT_FALSE(map.tared());
  map.add(frame(0, 20'000, 0));
  map.add(frame(0, 20'000, 0));
  EXPECT_TRUE(map.tared());
  EXPECT_TRUE(map.pressed().empty());
  TouchMap next(design, map.rest());
  next.add(frame(0, 20'000, 300));
  ASSERT_EQ(next.pressed().size(), 1U) << "the first sample counts when the rest is known";
  EXPECT_DOUBLE_EQ(next.pressed()[0].change_counts, 300);
}

// Two covers of a robot in one map: one was tared, the other rests by design.
TEST(TouchMap, rest_values_of_some_modules_leave_the_others_to_the_design) {
  const design::Design design = strip(3);
  TouchMap map(design);
  design::RestValues tared(2);
  for (auto& module : tared) module.fill(20'000);
  map.set_rest(tared, 1);
  for (int m = 0; m < 3; ++m) feed(map, frame(m, m == 0 ? layout::kRestCounts : 20'000, 400));
  ASSERT_EQ(map.pressed().size(), 2U);
  for (const PressedTaxel& p : map.pressed()) EXPECT_GT(p.module, 0);
  feed(map, frame(0, layout::kRestCounts, 0));
  feed(map, frame(0, layout::kRestCounts, 400));
  EXPECT_EQ(map.pressed().size(), 3U) << "a light touch at the start, which ended";
  EXPECT_THROW(map.set_rest(tared, 2), std::out_of_range);
}

TEST(LiveMonitor, draws_the_patch_in_its_shape) {
  const design::Design design = strip(4);
  LiveMonitor monitor(design);
  // A strip is one row: up, down, up, down.
  EXPECT_THAT(monitor.picture(0, PressureUnit::kCounts, false), ElementsAre("▲  -- ▼  -- ▲  -- ▼  -- "));
  for (int m = 0; m < 3; ++m) {
    for (int k = 0; k < 3; ++k) monitor.add(frame(m, layout::kRestCounts, m * 4'000));
  }
  EXPECT_THAT(monitor.picture(0, PressureUnit::kCounts, false), ElementsAre("▲   0 ▼4000 ▲8000 ▼  -- "));
  EXPECT_THAT(monitor.picture(0, PressureUnit::kPercent, false), ElementsAre("▲  0% ▼ 12% ▲ 24% ▼  -- "));
  EXPECT_THAT(monitor.picture(0, PressureUnit::kCounts, true)[0], HasSubstr("\033[48;5;172m▼4000\033[0m"));
}

TEST(LiveMonitor, rows_of_the_lattice_stand_above_each_other) {
  design::Design design = strip(3);
  // The third module becomes the down triangle below the first: cells (0, 1) up and (0, 0) down share a side.
  design.layout.modules[0].tile = {0, 1, true};
  design.layout.modules[1].tile = {0, 1, false};
  design.layout.modules[2].tile = {0, 0, false};
  const LiveMonitor monitor(design);
  EXPECT_THAT(monitor.picture(0, PressureUnit::kCounts, false), ElementsAre("▲  -- ▼  -- ", "▼  -- "));
}

TEST(LiveMonitor, says_what_is_wrong_and_how_fast_samples_come) {
  const design::Design design = strip(4, 2);
  LiveMonitor monitor(design);
  ModuleSample absent = frame(2, layout::kRestCounts, 0);
  absent.sample.state = wire::ModuleState::kAbsent;
  absent.sample.valid = 0;
  monitor.add(absent);
  for (int k = 0; k < 10; ++k) monitor.add(frame(0, layout::kRestCounts, 0));
  monitor.close_period(0.5);
  EXPECT_DOUBLE_EQ(monitor.rate_hz(0), 10.0);  // 20 a second of one module, none of the other
  EXPECT_EQ(monitor.unheard(0), 1);
  EXPECT_EQ(monitor.faults(0), 0);
  EXPECT_EQ(monitor.faults(1), 1);
  EXPECT_THAT(monitor.picture(1, PressureUnit::kCounts, false), ElementsAre("▲gone ▼  -- "));
  monitor.close_period(0.5);
  EXPECT_DOUBLE_EQ(monitor.rate_hz(0), 0.0);
}

}  // namespace
}  // namespace triskin::device
