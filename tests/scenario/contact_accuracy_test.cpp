// SPDX-License-Identifier: GPL-3.0-or-later
// These tests compare contacts found in the samples of a simulated skin, with a soft layer and noise, with the truth of
// the scene.
#include <gtest/gtest.h>

#include <cmath>

#include "support/strip_design.hpp"
#include "triskin/base/dice.hpp"
#include "triskin/scene/skin.hpp"
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
device::ContactFrame pressed_frame(const scene::Scene& scene) {
  const scene::Skin skin(scene);
  const auto wiring = design::wiring_of(scene.design);
  device::ContactFrame frame;
  for (std::size_t m = 0; m < scene.design.layout.modules.size(); ++m) {
    const scene::ModuleSkin& module = skin.module(static_cast<int>(m));
    const auto poses = design::taxels_of(scene.design.layout.modules[m], wiring[m].routed.rotation);
    for (int t = 0; t < layout::kTaxelsPerModule; ++t) {
      const auto& pose = poses[static_cast<std::size_t>(t)];
      frame.position_mm.push_back(pose.position_mm);
      frame.normal.push_back(pose.normal);
      frame.change_counts.push_back(module.counts(t, kSample_us) - module.rest_counts(t));
      frame.counts_per_kpa.push_back(module.counts_per_kpa(t));
    }
    frame.taxel_area_mm2.push_back(39.0);
  }
  return frame;
}

Accuracy accuracy_of(double radius_mm, int draws) {
  scene::Scene scene;
  scene.design = test::strip(12);
  scene.effects.noise_counts = 3.0;
  scene.effects.sensitivity_spread = 0.2;
  scene.effects.pads.layer = scene::LayerEffect{};
  Dice dice(20261125);
  Accuracy accuracy;
  for (int draw = 0; draw < draws; ++draw) {
    scene.seed = static_cast<std::uint64_t>(draw) + 1;
    const design::Vec3 at(30.0 + 120.0 * dice.unit(), 9.0 + 8.0 * dice.unit(), 0.0);
    scene.contacts = {{0, scene::kForever, at, {}, radius_mm, 2.0}};
    const auto contacts = device::contacts_of(pressed_frame(scene));
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

}  // namespace
}  // namespace triskin
