// SPDX-License-Identifier: GPL-3.0-or-later
// These tests compare contacts found in the samples of a simulated skin, with a soft layer and noise, with the truth of
// the scene.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "support/strip_design.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/hardware/skin.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "triskin/mechanics/contact_table.hpp"
#include "triskin/mechanics/pressure_contacts.hpp"
#include "triskin/mechanics/taxel.hpp"
#include "triskin/skin/skin_contacts.hpp"

namespace triskin {
namespace {

constexpr std::uint64_t kSample_us = 36'900;

struct Accuracy {
  int found = 0, with_three = 0;
  double force_square = 0.0, place_square = 0.0;
  double worst_single_mm = 0.0;
};

// Returns one calibrated sample of every module while a finger presses.
skin::ContactFrame pressed_frame(const hardware::Scene& scene) {
  const hardware::Skin skin(scene);
  const auto wiring = design::wiring_of(scene.design);
  skin::ContactFrame frame;
  for (std::size_t m = 0; m < scene.design.layout.modules.size(); ++m) {
    const hardware::ModuleSkin& module = skin.module(layout::ModuleId{m});
    const auto poses = design::taxels_of(scene.design.layout.modules[m], wiring[m].routed.rotation);
    for (int t = 0; t < layout::kTaxelsPerModule; ++t) {
      const auto& pose = poses[static_cast<std::size_t>(t)];
      frame.position_mm.push_back(pose.position_mm);
      frame.normal.push_back(pose.normal);
      frame.change_counts.push_back(module.counts(t, kSample_us) - module.rest_counts(layout::TaxelIndex{t}));
      frame.counts_per_kpa.push_back(module.counts_per_kpa(layout::TaxelIndex{t}));
    }
    frame.taxel_area_mm2.push_back(39.0);
  }
  return frame;
}

struct PressureTaxels {
  std::vector<design::Vec3> position_mm, normal;
};

PressureTaxels pressure_taxels(const design::Design& design) {
  PressureTaxels all;
  const auto wiring = design::wiring_of(design);
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const auto poses = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
    for (std::size_t t = 0; t < poses.size(); ++t) {
      if (!layout::measures_pressure(t)) continue;
      all.position_mm.push_back(poses[t].position_mm);
      all.normal.push_back(poses[t].normal);
    }
  }
  return all;
}

Accuracy accuracy_of(double radius_mm, int draws) {
  hardware::Scene scene;
  scene.design = test::strip(12);
  scene.effects.noise_counts = layout::kNoise_counts;
  scene.effects.sensitivity_spread = 0.2;
  scene.effects.pads.layer = hardware::LayerEffect{};
  Dice dice(20261125);
  Accuracy accuracy;
  for (int draw = 0; draw < draws; ++draw) {
    scene.seed = static_cast<std::uint64_t>(draw) + 1;
    const design::Vec3 at(30.0 + 120.0 * dice.unit(), 9.0 + 8.0 * dice.unit(), 0.0);
    scene.contacts = {{0, hardware::kForever, at, {}, radius_mm, 2.0}};
    const auto contacts = skin::contacts_of(pressed_frame(scene));
    if (contacts.size() != 1U) continue;
    ++accuracy.found;
    const double distance = (contacts[0].position_mm - at).norm();
    if (contacts[0].taxels.size() == 1U) accuracy.worst_single_mm = std::max(accuracy.worst_single_mm, distance);
    if (contacts[0].taxels.size() < 3U) continue;
    ++accuracy.with_three;
    accuracy.force_square += std::pow(contacts[0].force_n / 2.0 - 1.0, 2);
    accuracy.place_square += distance * distance;
  }
  return accuracy;
}

TEST(ContactAccuracy, a_finger_is_found_to_1_mm_and_5_percent_where_three_taxels_feel_it) {
  constexpr int kDraws = 100;
  const Accuracy a = accuracy_of(6.0, kDraws);
  EXPECT_GE(a.found, kDraws - 3);
  ASSERT_GT(a.with_three, kDraws / 2);
  const double force = std::sqrt(a.force_square / a.with_three), place_mm = std::sqrt(a.place_square / a.with_three);
  RecordProperty("force_rms_percent", std::to_string(100.0 * force));
  RecordProperty("place_rms_mm", std::to_string(place_mm));
  EXPECT_LT(force, 0.05);
  EXPECT_LT(place_mm, 1.0);
}

struct Scatter {
  double mean = 0.0, deviation = 0.0, place_mm = 0.0, within = 0.0;
};

// Presses a sphere on 150 places of a strip; the truth is the exact contact on the layer, not the footprint of the fit.
Scatter scatter_of(double radius_mm) {
  constexpr double kForce_n = 2.0, kNoise_kpa = layout::kNoise_counts / layout::kCountsPerKpa,
                   kPressed_kpa = layout::kPressed_counts / layout::kCountsPerKpa;
  constexpr int kDraws = 150;
  const mechanics::Layer layer{2.0, 0.3, 30.0};
  static const mechanics::ContactTable table{layer};
  static const mechanics::Footprint footprint{layer};
  const mechanics::Contact contact = table.press_to_radius({mechanics::Shape::kSphere, 60.0}, radius_mm);
  const double kpa_per_mm = kForce_n / contact.force * mechanics::confined_modulus_kpa(layer) / layer.thickness_mm;
  const auto [position_mm, normal] = pressure_taxels(test::strip(12));
  Dice dice(20261125);
  std::vector<double> forces;
  Scatter scatter;
  for (int draw = 0; draw < kDraws; ++draw) {
    const design::Vec3 at(30.0 + 120.0 * dice.unit(), 7.0 + 12.0 * dice.unit(), 0.0);
    std::vector<double> kpa;
    std::vector<std::size_t> pressed;
    for (const design::Vec3& p : position_mm) {
      // The sum of twelve uniform numbers has a variance of 1.
      double noise = -6.0;
      for (int k = 0; k < 12; ++k) noise += dice.unit();
      kpa.push_back(kpa_per_mm * mechanics::taxel_displacement_mm(contact, (p - at).norm()) + kNoise_kpa * noise);
      if (kpa.back() > kPressed_kpa) pressed.push_back(kpa.size() - 1);
    }
    const auto found = mechanics::contacts_from_pressure(footprint, position_mm, normal, kpa, pressed, {});
    EXPECT_EQ(found.size(), 1U) << at.transpose();
    if (found.empty()) continue;
    const auto& c = found[0].contact;
    forces.push_back(c.force_n / kForce_n);
    scatter.place_mm += (c.position_mm - at).squaredNorm() / kDraws;
    scatter.within += std::abs(c.force_n - kForce_n) < 1.96 * c.force_sd_n ? 1.0 / kDraws : 0.0;
  }
  for (const double f : forces) scatter.mean += f / static_cast<double>(forces.size());
  for (const double f : forces) scatter.deviation += std::pow(f - scatter.mean, 2) / static_cast<double>(forces.size());
  scatter.deviation = std::sqrt(scatter.deviation);
  scatter.place_mm = std::sqrt(scatter.place_mm);
  return scatter;
}

TEST(ContactAccuracy, TheForceOfASmallFingerScattersLittleOverItsPlaces) {
  // The pitch of the taxels limits the smallest finger (docs/calibration.md); the limit is its scatter of 11.0 % and
  // one standard error of 150 places, a share of 1/√300.
  for (const auto& [radius_mm, limit] : {std::pair(4.0, 0.117), std::pair(6.0, 0.05), std::pair(8.0, 0.02)}) {
    const Scatter s = scatter_of(radius_mm);
    std::printf("[ %2.0f mm ] mean %.3f, scatter %.1f %%, place %.2f mm RMS, within 1.96 deviations %.0f %%\n",
                radius_mm, s.mean, 100.0 * s.deviation, s.place_mm, 100.0 * s.within);
    EXPECT_LT(s.deviation, limit) << radius_mm;
    EXPECT_GE(s.within, 0.9) << radius_mm;
    EXPECT_LT(s.place_mm, 1.0) << radius_mm;
  }
}

}  // namespace
}  // namespace triskin
