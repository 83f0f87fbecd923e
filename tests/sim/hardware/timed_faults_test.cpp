// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault of a chip, a line or a pad must begin and end at the times of the scene.
#include <gtest/gtest.h>

#include "support/strip_design.hpp"
#include "triskin/hardware/skin.hpp"

namespace triskin::hardware {
namespace {

constexpr std::uint64_t kFrom = 1'000, kUntil = 2'000;

Scene with(Fault fault) {
  Scene scene;
  scene.design = test::strip(6);  // Module 5 has line 1, address 1.
  fault.from_us = kFrom;
  fault.until_us = kUntil;
  scene.faults = {fault};
  return scene;
}

Fault fault(FaultKind kind, int module, int other = -1) {
  Fault f;
  f.kind = kind;
  f.module = layout::ModuleId{module};
  f.other = layout::ModuleId{other};
  return f;
}

bool answers(Skin& skin, int line, int address, std::uint64_t at_us) {
  const bool yes =
      skin.line(layout::PatchIndex{0}, line).start(static_cast<std::uint8_t>((0x2C + address) << 1), at_us);
  skin.line(layout::PatchIndex{0}, line).stop(at_us);
  return yes;
}

// Reads the device id register 0x017 of the chip at a place.
int device_id(Skin& skin, int line, int address, std::uint64_t at_us) {
  I2cLineModel& model = skin.line(layout::PatchIndex{0}, line);
  const auto write = static_cast<std::uint8_t>((0x2C + address) << 1);
  EXPECT_TRUE(model.start(write, at_us));
  (void)model.write(0x00, at_us);
  (void)model.write(0x17, at_us);
  EXPECT_TRUE(model.start(static_cast<std::uint8_t>(write | 1), at_us));
  const int high = model.read(true, at_us), low = model.read(false, at_us);
  model.stop(at_us);
  return high << 8 | low;
}

TEST(TimedFaults, a_removed_chip_comes_back) {
  Skin skin(with(fault(FaultKind::kRemovedChip, 5)));
  EXPECT_TRUE(answers(skin, 1, 1, kFrom - 1));
  EXPECT_FALSE(answers(skin, 1, 1, kFrom));
  EXPECT_TRUE(answers(skin, 1, 1, kUntil));
}

TEST(TimedFaults, a_moved_chip_moves_and_moves_back) {
  Fault f = fault(FaultKind::kMovedChip, 5);
  f.line = 3;
  f.address = 2;
  Skin skin(with(f));
  EXPECT_TRUE(answers(skin, 1, 1, 0));
  EXPECT_FALSE(answers(skin, 3, 2, 0));
  EXPECT_FALSE(answers(skin, 1, 1, kFrom));
  EXPECT_TRUE(answers(skin, 3, 2, kFrom));
  EXPECT_TRUE(answers(skin, 1, 1, kUntil));
}

TEST(TimedFaults, a_wrong_id_is_shown_for_a_time) {
  Fault f = fault(FaultKind::kWrongId, 5);
  f.value = 0xABCD;
  Skin skin(with(f));
  EXPECT_EQ(device_id(skin, 1, 1, 0), Ad7147::kDeviceId);
  EXPECT_EQ(device_id(skin, 1, 1, kFrom), 0xABCD);
  EXPECT_EQ(device_id(skin, 1, 1, kUntil), Ad7147::kDeviceId);
}

TEST(TimedFaults, swapped_chips_sit_at_each_others_place) {
  // The wrong id distinguishes the chip of module 5 from that of module 0.
  Scene scene = with(fault(FaultKind::kSwappedChips, 0, 5));
  Fault marked = fault(FaultKind::kWrongId, 5);
  marked.value = 0xABCD;
  scene.faults.push_back(marked);
  Skin skin(scene);
  EXPECT_EQ(device_id(skin, 1, 1, 0), 0xABCD);
  EXPECT_EQ(device_id(skin, 0, 0, kFrom), 0xABCD);
  EXPECT_EQ(device_id(skin, 1, 1, kFrom), Ad7147::kDeviceId);
  EXPECT_EQ(device_id(skin, 1, 1, kUntil), 0xABCD);
}

TEST(TimedFaults, a_stuck_line_is_released) {
  Fault f;
  f.kind = FaultKind::kStuckLine;
  f.patch = layout::PatchIndex{0};
  f.line = 1;
  Skin skin(with(f));
  EXPECT_TRUE(answers(skin, 1, 1, 0));
  EXPECT_FALSE(answers(skin, 1, 1, kFrom));
  EXPECT_TRUE(answers(skin, 0, 0, kFrom));
  EXPECT_TRUE(answers(skin, 1, 1, kUntil));
}

// The strip is a chain: modules 0 … 3 have line 0, modules 4 and 5 line 1.
TEST(TimedFaults, an_open_line_silences_its_modules_from_the_joint_on) {
  Fault f = fault(FaultKind::kOpenLine, 2);
  f.line = 0;
  Skin skin(with(f));
  for (const int address : {2, 3}) {
    EXPECT_TRUE(answers(skin, 0, address, kFrom - 1)) << address;
    EXPECT_FALSE(answers(skin, 0, address, kFrom)) << address;
    EXPECT_TRUE(answers(skin, 0, address, kUntil)) << address;
  }
  EXPECT_TRUE(answers(skin, 0, 1, kFrom));
  EXPECT_TRUE(answers(skin, 1, 0, kFrom)) << "the other lines pass the joint";
}

TEST(TimedFaults, a_loose_plug_takes_all_that_is_behind_it) {
  Skin skin(with(fault(FaultKind::kLoosePlug, 3)));
  EXPECT_TRUE(answers(skin, 0, 2, kFrom));
  for (const auto& [line, address] : {std::pair{0, 3}, {1, 0}, {1, 1}}) {
    EXPECT_TRUE(answers(skin, line, address, 0));
    EXPECT_FALSE(answers(skin, line, address, kFrom));
    EXPECT_TRUE(answers(skin, line, address, kUntil));
  }
}

// 200,000 counts/s over the 500 µs since it began are 100 counts; after its end they stay.
TEST(TimedFaults, a_chip_drifts_until_it_stops) {
  Fault f = fault(FaultKind::kDriftingChip, 5);
  f.value = 200'000;
  const Skin skin(with(f));
  const ModuleSkin& m = skin.module(layout::ModuleId{5});
  for (const int taxel : {0, 6}) {
    const double rest = m.rest_counts(layout::TaxelIndex{taxel});
    EXPECT_DOUBLE_EQ(m.counts(taxel, kFrom), rest);
    EXPECT_DOUBLE_EQ(m.counts(taxel, kFrom + 500), rest + 100.0);
    EXPECT_DOUBLE_EQ(m.counts(taxel, kUntil + 500), rest + 200.0);
  }
  const ModuleSkin& other = skin.module(layout::ModuleId{4});
  EXPECT_DOUBLE_EQ(other.counts(0, kUntil), other.rest_counts(layout::TaxelIndex{0}));
}

TEST(TimedFaults, pads_are_saturated_and_frozen_for_a_time) {
  Fault f = fault(FaultKind::kSaturatedTaxel, 5);
  f.taxel = layout::TaxelIndex{3};
  Scene scene = with(f);
  f.kind = FaultKind::kFrozenTaxel;
  f.taxel = layout::TaxelIndex{4};
  f.from_us = kFrom;
  f.until_us = kUntil;
  scene.faults.push_back(f);
  scene.pressure = PressureCurve({{0, 10.0}});
  const Skin skin(scene);
  const ModuleSkin& m = skin.module(layout::ModuleId{5});
  for (const std::uint64_t healthy : {std::uint64_t{0}, kUntil}) {
    EXPECT_DOUBLE_EQ(m.counts(3, healthy), m.rest_counts(layout::TaxelIndex{3}) + 10.0 * kCountsPerKpa);
    EXPECT_DOUBLE_EQ(m.counts(4, healthy), m.rest_counts(layout::TaxelIndex{4}) + 10.0 * kCountsPerKpa);
  }
  EXPECT_LT(m.counts(3, kFrom), -32'768.0);
  EXPECT_DOUBLE_EQ(m.counts(4, kFrom), m.rest_counts(layout::TaxelIndex{4}));
  EXPECT_DOUBLE_EQ(m.counts(5, kFrom), m.rest_counts(layout::TaxelIndex{5}) + 10.0 * kCountsPerKpa);
}

TEST(TimedFaults, a_turned_module_feels_a_tip_with_another_taxel) {
  Fault f = fault(FaultKind::kRotatedModule, 0);
  f.value = 1;
  Scene scene = with(f);
  Contact tip;
  // The modules of the strip have rotation 2.
  tip.position_mm = design::taxels_of(scene.design.layout.modules[0], 2)[0].position_mm;
  tip.radius_mm = 1.0;
  scene.contacts = {tip};
  const Skin skin(scene);
  const ModuleSkin& m = skin.module(layout::ModuleId{0});
  EXPECT_GT(m.counts(0, 0), m.rest_counts(layout::TaxelIndex{0}));
  EXPECT_DOUBLE_EQ(m.counts(0, kFrom), m.rest_counts(layout::TaxelIndex{0}));
  EXPECT_GT(m.counts(0, kUntil), m.rest_counts(layout::TaxelIndex{0}));
}

TEST(TimedFaults, power_dips_end) {
  Scene scene;
  scene.design = test::strip(1);
  const Skin skin(scene);
  Ad7147 chip(skin.module(layout::ModuleId{0}));
  chip.schedule_power_dip(1'000, 1'000, 2'500);
  const auto lost_at = [&](std::uint64_t at_us) {
    const bool lost = chip.read_register(0x003, at_us) == 0;
    chip.write_register(0x003, 0x1234, at_us);
    return lost;
  };
  EXPECT_TRUE(lost_at(0));
  EXPECT_FALSE(lost_at(999));
  EXPECT_TRUE(lost_at(1'000));
  EXPECT_TRUE(lost_at(2'000));
  EXPECT_FALSE(lost_at(9'000));
}

}  // namespace
}  // namespace triskin::hardware
