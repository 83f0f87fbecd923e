// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/skin.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/strip_design.hpp"
#include "triskin/wire/bus_load.hpp"

namespace triskin::hardware {
namespace {

using test::strip;

Scene scene_of(int modules) {
  Scene scene;
  scene.design = strip(modules);
  return scene;
}

TEST(SkinModel, pressure_is_that_of_hertz) {
  Scene scene = scene_of(1);
  // Taxel 3 is at the centroid, taxel 0 at 6.533 mm from it. F = 2 N, r = 10 mm: p0 = 3·2/(2π·1e-4) = 9549.3 Pa.
  const Touch touch{1, {100, 200, center_of(scene.design, layout::ModuleId{0}), {}, 10.0, 2.0}};
  ModuleSkin skin(scene, layout::ModuleId{0}, 0);
  skin.add(touch);
  const auto rest = [&](int taxel) { return skin.rest_counts(layout::TaxelIndex{taxel}); };
  EXPECT_DOUBLE_EQ(skin.counts(3, 99), rest(3));
  EXPECT_NEAR(skin.counts(3, 100), rest(3) + 9.5493 * kCountsPerKpa, 0.01);
  EXPECT_NEAR(skin.counts(0, 150), rest(0) + 9.5493 * kCountsPerKpa * std::sqrt(1 - 0.6533 * 0.6533), 0.01);
  EXPECT_DOUBLE_EQ(skin.counts(3, 200), rest(3));
  // Taxel 10 (7.507 mm) measures temperature; pin 12 is open.
  EXPECT_DOUBLE_EQ(skin.counts(10, 150), rest(10));
  EXPECT_DOUBLE_EQ(skin.counts(12, 150), 0.0);
  skin.remove(1);
  EXPECT_DOUBLE_EQ(skin.counts(3, 150), rest(3));
}

TEST(SkinModel, a_moving_contact_passes_over_the_pads) {
  Scene scene = scene_of(4);
  const design::Vec3 from = center_of(scene.design, layout::ModuleId{0}),
                     to = center_of(scene.design, layout::ModuleId{2});
  const Touch touch{1, {0, 1000, from, to, 4.0, 1.0}};
  ModuleSkin far(scene, layout::ModuleId{2}, 0);
  ASSERT_TRUE(far.reached_by(touch.contact));
  far.add(touch);
  EXPECT_DOUBLE_EQ(far.counts(3, 0), far.rest_counts(layout::TaxelIndex{3}));
  EXPECT_GT(far.counts(3, 999), far.rest_counts(layout::TaxelIndex{3}) + 100);
  EXPECT_FALSE(ModuleSkin(scene, layout::ModuleId{3}, 0)
                   .reached_by({0, 1, center_of(scene.design, layout::ModuleId{0}), {}, 4.0, 1.0}));
}

TEST(SkinModel, noise_is_seeded_and_has_the_deviation_asked_for) {
  Scene scene = scene_of(1);
  scene.effects.noise_counts = 5.0;
  const ModuleSkin a(scene, layout::ModuleId{0}, 0), same(scene, layout::ModuleId{0}, 0);
  scene.seed = 2;
  const ModuleSkin other(scene, layout::ModuleId{0}, 0);
  double sum = 0, sum2 = 0;
  int equal = 0;
  constexpr int kSamples = 20'000;
  for (int k = 0; k < kSamples; ++k) {
    const auto t = static_cast<std::uint64_t>(k) * 36'900;
    const double x = a.counts(1, t) - a.rest_counts(layout::TaxelIndex{1});
    EXPECT_DOUBLE_EQ(same.counts(1, t) - same.rest_counts(layout::TaxelIndex{1}), x);
    equal += other.counts(1, t) - other.rest_counts(layout::TaxelIndex{1}) == x ? 1 : 0;
    sum += x;
    sum2 += x * x;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.15);  // The tolerance is four standard errors.
  EXPECT_NEAR(std::sqrt(sum2 / kSamples), 5.0, 0.1);
  EXPECT_EQ(equal, 0);
}

TEST(SkinModel, each_taxel_has_its_own_electrode_of_a_sixth_to_15_pF) {
  Scene scene = scene_of(4);
  double least = 1e9, most = 0.0;
  for (int m = 0; m < 4; ++m) {
    const ModuleSkin skin(scene, layout::ModuleId{m}, 0), same(scene, layout::ModuleId{m}, 0);
    for (int t = 0; t < 12; ++t) {
      EXPECT_EQ(skin.rest_counts(layout::TaxelIndex{t}), same.rest_counts(layout::TaxelIndex{t}));
      least = std::min(least, skin.rest_counts(layout::TaxelIndex{t}));
      most = std::max(most, skin.rest_counts(layout::TaxelIndex{t}));
    }
  }
  EXPECT_GE(least, 0.15 * 4096);
  EXPECT_LE(most, 15.0 * 4096);
  EXPECT_GT(most - least, 12.0 * 4096);
  scene.effects.electrode_least_pf = scene.effects.electrode_most_pf = 7.0;
  EXPECT_DOUBLE_EQ(ModuleSkin(scene, layout::ModuleId{0}, 0).rest_counts(layout::TaxelIndex{5}), 7.0 * 4096);
}

// Each pad responds to the pressure by its own gain; pads 6 and 10 do not respond.
TEST(SkinModel, a_pressure_everywhere_changes_each_taxel_by_its_sensitivity) {
  Scene scene = scene_of(2);
  scene.effects.sensitivity_spread = 0.3;
  scene.pressure = PressureCurve({{1'000'000, 0.0}, {3'000'000, 20.0}});
  const ModuleSkin skin(scene, layout::ModuleId{1}, 0), same(scene, layout::ModuleId{1}, 0);
  double least = 1e9, most = 0.0;
  for (int t = 0; t < 12; ++t) {
    EXPECT_EQ(skin.counts_per_kpa(layout::TaxelIndex{t}), same.counts_per_kpa(layout::TaxelIndex{t}));
    least = std::min(least, skin.counts_per_kpa(layout::TaxelIndex{t}));
    most = std::max(most, skin.counts_per_kpa(layout::TaxelIndex{t}));
    const bool feels = t != 6 && t != 10;
    EXPECT_NEAR(skin.counts(t, 2'000'000) - skin.counts(t, 0),
                feels ? 10.0 * skin.counts_per_kpa(layout::TaxelIndex{t}) : 0.0, 1e-6);
    EXPECT_NEAR(skin.counts(t, 9'000'000) - skin.counts(t, 0),
                feels ? 20.0 * skin.counts_per_kpa(layout::TaxelIndex{t}) : 0.0, 1e-6);
  }
  EXPECT_GE(least, 7.0);
  EXPECT_LE(most, 13.0);
  EXPECT_GT(most - least, 2.0);
  scene.effects.sensitivity_spread = 0.0;
  EXPECT_EQ(ModuleSkin(scene, layout::ModuleId{1}, 0).counts_per_kpa(layout::TaxelIndex{3}), kCountsPerKpa);
}

TEST(PressureCurve, is_linear_between_points_and_steps_from_now_on) {
  PressureCurve curve({{1'000, 0.0}, {3'000, 20.0}});
  EXPECT_EQ(curve.kpa(0), 0.0);
  EXPECT_EQ(curve.kpa(1'500), 5.0);
  EXPECT_EQ(curve.kpa(5'000), 20.0);
  curve.step(2'000, 3.0);
  EXPECT_EQ(curve.kpa(1'500), 5.0);
  EXPECT_EQ(curve.kpa(1'999), 9.99);
  EXPECT_EQ(curve.kpa(2'000), 3.0);
  EXPECT_EQ(curve.kpa(5'000), 3.0);
  curve.step(2'000, 0.0);
  EXPECT_EQ(curve.kpa(2'000), 0.0);
  EXPECT_EQ(PressureCurve().kpa(7), 0.0);
}

bool answers(Skin& skin, int line, int address) {
  const bool yes = skin.line(layout::PatchIndex{0}, line).start(static_cast<std::uint8_t>((0x2C + address) << 1), 0);
  skin.line(layout::PatchIndex{0}, line).stop(0);
  return yes;
}

TEST(SkinModel, chips_sit_where_the_design_and_the_faults_put_them) {
  Scene scene = scene_of(6);  // Module 5 has line 1, address 1.
  EXPECT_TRUE(answers(*std::make_unique<Skin>(scene), 1, 1));
  EXPECT_FALSE(answers(*std::make_unique<Skin>(scene), 1, 2));
  Fault moved;
  moved.kind = FaultKind::kMovedChip;
  moved.module = layout::ModuleId{5};
  moved.line = 3;
  moved.address = 2;
  Fault removed;
  removed.kind = FaultKind::kRemovedChip;
  removed.module = layout::ModuleId{0};
  scene.faults = {moved, removed};
  Skin skin(scene);
  EXPECT_FALSE(answers(skin, 1, 1));
  EXPECT_TRUE(answers(skin, 3, 2));
  EXPECT_FALSE(answers(skin, 0, 0));
  EXPECT_TRUE(answers(skin, 0, 1));
}

// By ISO 11898-1, an extended classic frame with 8 bytes has 1 + 32 + 6 + 64 + 15 = 118 bits that may be stuffed, at
// most 29 stuff bits, and 13 more bits from the CRC delimiter to the interframe space.
TEST(BusTime, classic_frames_have_the_worst_case_length) {
  wire::CanFrame frame;
  frame.extended = true;
  frame.size = 8;
  EXPECT_EQ(wire::bits_of(frame).nominal, 118 + 29 + 13);
  frame.extended = false;
  EXPECT_EQ(wire::bits_of(frame).nominal, 98 + 24 + 13);
  EXPECT_EQ(wire::bits_of(frame).data, 0);
}

}  // namespace
}  // namespace triskin::hardware
