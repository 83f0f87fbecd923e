// SPDX-License-Identifier: GPL-3.0-or-later
// Tests what live tracks and shows: rest values, contacts that are there from the start, the picture of a patch.
#include "triskin/skin/live_monitor.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "support/strip_design.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/skin/taxel_trace.hpp"

namespace triskin::skin {
namespace {

using test::strip;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kPad = 3;

// Makes a sample of a module that rests at `rest`, with one taxel `pressure` counts below.
session::ModuleSample frame(int module, double rest, double pressure) {
  session::ModuleSample f;
  f.module = layout::ModuleId{module};
  f.sample.valid = layout::kAllTaxels;
  f.sample.state = wire::ModuleState::kOk;
  f.sample.value.fill(static_cast<std::uint16_t>(rest));
  f.sample.value[kPad] = static_cast<std::uint16_t>(rest - pressure);
  return f;
}

void feed(skin::TouchMap& map, const session::ModuleSample& f) {
  for (std::size_t k = 0; k < skin::TouchMap::kRestSamples; ++k) map.add(f);
}

// The controllers settled all offsets at this value.
design::RestValues settled_at(std::size_t modules, double counts) {
  design::RestValues settled(modules);
  for (auto& module : settled) module.fill(counts);
  return settled;
}

TEST(TouchMap, a_contact_that_is_there_at_the_start_is_shown) {
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  map.settle(settled_at(2, layout::kRestCounts));
  feed(map, frame(0, layout::kRestCounts, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_EQ(map.pressed()[0].taxel, kPad);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 4'000);
  feed(map, frame(0, layout::kRestCounts, 0));
  EXPECT_TRUE(map.pressed().empty());
}

// The taxel has moved down by 150 counts since its offset was settled, which nobody could know while an object lay on
// it.
TEST(TouchMap, a_contact_that_is_there_at_the_start_ends_without_a_ghost) {
  constexpr double kNow = layout::kRestCounts - 150;
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  design::RestValues settled = settled_at(2, kNow);
  settled[0][kPad] = layout::kRestCounts;
  map.settle(settled);
  feed(map, frame(0, kNow, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  map.add(frame(0, kNow, 100));  // The object is being lifted.
  feed(map, frame(0, kNow, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(0, kNow, 4'000));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 4'000);
}

// Half an hour of samples with the noise of a taxel must not lift its rest value by half of what counts as pressed.
TEST(TouchMap, noise_hardly_moves_a_rest_value_that_follows) {
  const design::Design design = strip(1);
  skin::TouchMap map(design);
  std::mt19937 random(20261127);
  std::normal_distribution<double> noise(0.0, layout::kNoise_counts);
  for (int k = 0; k < 27 * 1800; ++k) map.add(frame(0, layout::kRestCounts + std::round(noise(random)), 0));
  map.add(frame(0, layout::kRestCounts, 0));
  EXPECT_LT(map.change(layout::ModuleId{0})[kPad], 0.5 * skin::TouchMap::kPressed_counts);
  EXPECT_TRUE(map.pressed().empty());
}

TEST(TouchMap, modules_that_rest_beside_the_design_are_not_pressed) {
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts - 900, 0));
  feed(map, frame(1, layout::kRestCounts + 900, 0));
  EXPECT_TRUE(map.pressed().empty());
  // The controller took a finger for rest, and the finger has left.
  feed(map, frame(0, layout::kRestCounts + 8'000, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(1, layout::kRestCounts + 900, 250));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 250);
}

TEST(TouchMap, a_light_touch_within_the_band_ends_without_a_ghost) {
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  feed(map, frame(0, layout::kRestCounts, 500));
  feed(map, frame(0, layout::kRestCounts, 0));
  EXPECT_TRUE(map.pressed().empty());
  feed(map, frame(0, layout::kRestCounts, 500));
  EXPECT_EQ(map.pressed().size(), 1U);
}

// No offset of this chip cancels the electrode of one taxel: it rests 8,600 counts below the middle, where another one
// would be pressed hard. Both are told apart by what the controller said, and a touch of each shows in full.
TEST(TouchMap, a_taxel_that_rests_off_the_middle_is_not_pressed) {
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  design::RestValues settled = settled_at(2, layout::kRestCounts);
  settled[0][kPad] -= 8'600;
  map.settle(settled);
  feed(map, frame(0, layout::kRestCounts, 8'600));
  feed(map, frame(1, layout::kRestCounts, 8'600));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_EQ(map.pressed()[0].module, 1);
  map.add(frame(0, layout::kRestCounts, 8'600 + 300));
  ASSERT_EQ(map.pressed().size(), 2U);
  EXPECT_DOUBLE_EQ(map.pressed()[1].change_counts, 300);
}

// The controller was still searching when it was asked, so the first values are those with the settled offsets.
TEST(TouchMap, without_a_word_from_the_controller_the_first_values_are_rest) {
  const design::Design design = strip(1);
  skin::TouchMap map(design);
  map.settle(settled_at(1, std::numeric_limits<double>::quiet_NaN()));
  feed(map, frame(0, layout::kRestCounts, 8'600));
  EXPECT_TRUE(map.pressed().empty());
  map.add(frame(0, layout::kRestCounts, 8'600 + 300));
  ASSERT_EQ(map.pressed().size(), 1U);
}

// All pads have lost 700 counts to warmth since the offsets were settled; a finger of 300 counts came before the
// program.
TEST(TouchMap, warmth_since_the_offsets_were_settled_is_no_contact) {
  const design::Design design = strip(1);
  skin::TouchMap map(design);
  map.settle(settled_at(1, layout::kRestCounts));
  feed(map, frame(0, layout::kRestCounts - 700, 300));
  ASSERT_EQ(map.pressed().size(), 1U);
  EXPECT_DOUBLE_EQ(map.pressed()[0].change_counts, 300);
}

TEST(TouchMap, a_tare_holds_whatever_the_rest_is_and_can_be_kept) {
  const design::Design design = strip(2);
  skin::TouchMap map(design);
  map.settle(settled_at(2, layout::kRestCounts));
  feed(map, frame(0, 20'000, 0));
  EXPECT_TRUE(map.pressed().empty()) << "the pads as well: warmth";
  map.tare();
  map.add(frame(0, 20'000, 0));
  EXPECT_FALSE(map.tared());
  map.add(frame(0, 20'000, 0));
  map.add(frame(0, 20'000, 0));
  EXPECT_TRUE(map.tared());
  EXPECT_TRUE(map.pressed().empty());
  skin::TouchMap next(design, {map.rest(), {}});
  next.add(frame(0, 20'000, 300));
  ASSERT_EQ(next.pressed().size(), 1U) << "the first sample counts when the rest is known";
  EXPECT_DOUBLE_EQ(next.pressed()[0].change_counts, 300);
}

// Two covers of a robot are in one map: one was tared, of the other the controllers say where it rests.
TEST(TouchMap, rest_values_of_some_modules_leave_the_others_alone) {
  const design::Design design = strip(3);
  skin::TouchMap map(design);
  map.settle(settled_at(3, layout::kRestCounts));
  design::RestValues tared(2);
  for (auto& module : tared) module.fill(20'000);
  map.set_rest(tared, layout::ModuleId{1});
  for (int m = 0; m < 3; ++m) feed(map, frame(m, m == 0 ? layout::kRestCounts : 20'000, m == 0 ? 150 : 400));
  ASSERT_EQ(map.pressed().size(), 2U);
  for (const skin::PressedTaxel& p : map.pressed()) EXPECT_GT(p.module, 0);
  feed(map, frame(0, layout::kRestCounts, 0));
  feed(map, frame(0, layout::kRestCounts, 400));
  EXPECT_EQ(map.pressed().size(), 3U) << "a light touch at the start, which ended";
  EXPECT_THROW(map.set_rest(tared, layout::ModuleId{2}), std::out_of_range);
}

TEST(LiveMonitor, draws_the_patch_in_its_shape) {
  const design::Design design = strip(4);
  LiveMonitor monitor(design);
  monitor.touches().settle(settled_at(design.layout.modules.size(), layout::kRestCounts));
  // A strip is one row of up, down, up, down.
  EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, false),
              ElementsAre("▲  -- ▼  -- ▲  -- ▼  -- "));
  for (int m = 0; m < 3; ++m) {
    for (int k = 0; k < 3; ++k) monitor.add(frame(m, layout::kRestCounts, m * 4'000));
  }
  EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, false),
              ElementsAre("▲   0 ▼4000 ▲8000 ▼  -- "));
  EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kPercent, false),
              ElementsAre("▲  0% ▼ 12% ▲ 24% ▼  -- "));
  EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, true)[0],
              HasSubstr("\033[48;5;160m▼4000\033[0m"));
}

// The colours begin at 2, 7, 20 and 50 kPa.
TEST(LiveMonitor, has_a_colour_for_each_strength) {
  const design::Design design = strip(1);
  for (const auto& [counts, colour] : {std::pair(15, 236), {25, 22}, {100, 34}, {300, 172}, {600, 160}}) {
    LiveMonitor monitor(design);
    for (const int change : {0, 0, 0, counts}) monitor.add(frame(0, layout::kRestCounts, change));
    EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, true)[0],
                HasSubstr(fmt::format("48;5;{}m", colour)));
  }
}

TEST(LiveMonitor, shows_numbers_of_modules_in_their_cells) {
  const design::Design design = strip(3);
  LiveMonitor monitor(design);
  monitor.touches().settle(settled_at(design.layout.modules.size(), layout::kRestCounts));
  for (int k = 0; k < 3; ++k) monitor.add(frame(2, layout::kRestCounts, 8'000));
  constexpr layout::PatchIndex kPatch{0};
  EXPECT_THAT(monitor.picture(kPatch, skin::PressureUnit::kModule, false), ElementsAre("▲   0 ▼   1 ▲   2 "));
  EXPECT_THAT(monitor.picture(kPatch, skin::PressureUnit::kModule, true)[0], HasSubstr("\033[48;5;160m▲   2\033[0m"));
}

// The rest values are from a tare. Module 1 was exchanged since: one taxel reads 300 above, all others 50.
TEST(LiveMonitor, says_which_taxels_do_not_rest) {
  const design::Design design = strip(3);
  design::RestValues tared(3);
  for (auto& module : tared) module.fill(20'000);
  LiveMonitor monitor(design, {tared, {}});
  EXPECT_EQ(sentence(monitor.off_rest()), "") << "nothing was heard";
  monitor.add(frame(0, 20'000, 4'000));
  EXPECT_EQ(monitor.off_rest().taxels, 0) << "a touch is none";
  monitor.add(frame(1, 20'050, -250));
  EXPECT_THAT(monitor.off_rest().modules, ElementsAre(1));
  EXPECT_EQ(sentence(monitor.off_rest()), "1 taxel does not rest: tare; its module: 1");
  session::ModuleSample saturated = frame(2, 20'000, -30'000);
  saturated.sample.state = wire::ModuleState::kSaturated;
  monitor.add(saturated);
  EXPECT_EQ(monitor.off_rest().taxels, 1) << "a module with a fault has another cause";
  design::OffRest many{24, {}};
  for (int k = 0; k < 14; ++k) many.modules.push_back({k});
  EXPECT_EQ(sentence(many),
            "24 taxels do not rest: tare; their modules: 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 2 more");
}

// The strongest taxel rises from 0 to 8,000 counts, so the newest value has the highest block.
TEST(TaxelTrace, plots_the_strongest_taxel_or_the_one_that_is_held) {
  const design::Design design = strip(3);
  LiveMonitor monitor(design);
  skin::TaxelTrace trace;
  for (int k = 0; k < 3; ++k) monitor.add(frame(1, layout::kRestCounts, 0));
  trace.step(monitor);
  EXPECT_TRUE(trace.lines(80, 0.2).empty()) << "nothing was pressed yet";
  for (int k = 1; k <= 8; ++k) {
    monitor.add(frame(1, layout::kRestCounts, 1'000.0 * k));
    trace.step(monitor);
  }
  const auto lines = trace.lines(80, 0.25);
  EXPECT_THAT(lines, ElementsAre("module 1 taxel 3, last 2 s, up to 8000 counts", "▁▂▃▄▅▆▇█"));
  EXPECT_THAT(trace.lines(2, 0.25)[1], "▇█") << "as many values as the line has columns";
  trace.toggle_hold();
  for (int k = 0; k < 3; ++k) monitor.add(frame(2, layout::kRestCounts, k == 2 ? 20'000 : 0));
  trace.step(monitor);
  EXPECT_THAT(trace.lines(80, 0.25)[0], HasSubstr("module 1 taxel 3 (held)"));
  trace.toggle_hold();
  trace.step(monitor);
  EXPECT_THAT(trace.lines(80, 0.25)[0], HasSubstr("module 2 taxel 3,"));
}

TEST(LiveMonitor, rows_of_the_lattice_stand_above_each_other) {
  design::Design design = strip(3);
  // The third module becomes the down triangle below the first: cells (0, 1) up and (0, 0) down share a side.
  design.layout.modules[0].tile = {0, 1, true};
  design.layout.modules[1].tile = {0, 1, false};
  design.layout.modules[2].tile = {0, 0, false};
  const LiveMonitor monitor(design);
  EXPECT_THAT(monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, false),
              ElementsAre("▲  -- ▼  -- ", "▼  -- "));
}

// Returns the characters on the screen: bytes that begin a code point, because no colours are requested.
std::size_t columns_of(const std::string& line) {
  return static_cast<std::size_t>(
      std::ranges::count_if(line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

TEST(LiveMonitor, a_picture_fits_the_width) {
  const design::Design design = strip(16);
  LiveMonitor monitor(design);
  monitor.touches().settle(settled_at(design.layout.modules.size(), layout::kRestCounts));
  for (int k = 0; k < 3; ++k) monitor.add(frame(2, layout::kRestCounts, 8'000));
  // Sixteen cells take 96 characters with spaces, 80 without, 32 with one digit per cell.
  const auto line = [&](int columns) {
    return monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, false, columns).at(0);
  };
  EXPECT_EQ(line(0), line(96));
  EXPECT_EQ(columns_of(line(140)), 96U);
  EXPECT_EQ(columns_of(line(80)), 80U);
  EXPECT_THAT(line(80), StartsWith("▲  --▼  --▲8000▼  --"));
  EXPECT_EQ(columns_of(line(60)), 32U);
  EXPECT_THAT(line(60), StartsWith("▲-▼-▲2▼-"));  // 8,000 of 33,000 counts are slightly more than two tenths.
  EXPECT_EQ(line(9), "▲-▼-▲2▼-…");
  for (std::size_t columns = 3; columns < 120; ++columns)
    EXPECT_LE(columns_of(line(static_cast<int>(columns))), columns);
}

TEST(LiveMonitor, islands_of_a_patch_stand_side_by_side_and_never_on_each_other) {
  design::Design design = strip(6);
  // There are three islands of two modules, each with the same places in its own lattice.
  for (int m = 0; m < 6; ++m) {
    design.layout.modules[static_cast<std::size_t>(m)].island = m / 2;
    design.layout.modules[static_cast<std::size_t>(m)].tile =
        design.layout.modules[static_cast<std::size_t>(m % 2)].tile;
  }
  const LiveMonitor monitor(design);
  const auto picture = [&](int columns) {
    return monitor.picture(layout::PatchIndex{0}, skin::PressureUnit::kCounts, false, columns);
  };
  EXPECT_THAT(picture(80),
              ElementsAre("island 0       island 1       island 2",  // Three islands of 12 characters fit.
                          "▲  -- ▼  --    ▲  -- ▼  --    ▲  -- ▼  -- "));
  EXPECT_EQ(picture(140), picture(80));
  EXPECT_THAT(picture(30),
              ElementsAre("island 0       island 1",  // Two islands fit in a row.
                          "▲  -- ▼  --    ▲  -- ▼  -- ", "island 2", "▲  -- ▼  -- "));
}

TEST(LiveMonitor, says_what_is_wrong_and_how_fast_samples_come) {
  const design::Design design = strip(4, 2);
  LiveMonitor monitor(design);
  session::ModuleSample absent = frame(2, layout::kRestCounts, 0);
  absent.sample.state = wire::ModuleState::kAbsent;
  absent.sample.valid = 0;
  monitor.add(absent);
  for (int k = 0; k < 10; ++k) monitor.add(frame(0, layout::kRestCounts, 0));
  monitor.close_period(0.5);
  EXPECT_DOUBLE_EQ(monitor.rate_hz(layout::PatchIndex{0}), 10.0);  // One module has 20 a second, the other none.
  EXPECT_EQ(monitor.unheard(layout::PatchIndex{0}), 1);
  EXPECT_EQ(monitor.faults(layout::PatchIndex{0}), 0);
  EXPECT_EQ(monitor.faults(layout::PatchIndex{1}), 1);
  const auto picture = monitor.picture(layout::PatchIndex{1}, skin::PressureUnit::kCounts, false);
  EXPECT_THAT(picture, ElementsAre("▲gone ▼  -- "));
  monitor.close_period(0.5);
  EXPECT_DOUBLE_EQ(monitor.rate_hz(layout::PatchIndex{0}), 0.0);
}

}  // namespace
}  // namespace triskin::skin
