// SPDX-License-Identifier: GPL-3.0-or-later
// These tests compare the effects of the surroundings on the pads with values worked by hand.
#include "triskin/scene/effects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene_case.hpp"
#include "triskin/scene/skin.hpp"

namespace triskin::scene {
namespace {

constexpr std::uint64_t kSecond_us = 1'000'000;

Scene scene_of_strip() {
  Scene scene;
  scene.design = test::strip(2);
  return scene;
}

TEST(Effects, TemperatureMovesEveryPadAlike) {
  Scene scene = scene_of_strip();
  scene.effects.pads.temperature =
      TemperatureEffect{.celsius = {{0, 20.0}, {10 * kSecond_us, 30.0}}, .counts_per_degree = 20.0};
  const ModuleSkin skin(scene, 0, 0);
  // After 5 s the pads are 5 degrees warmer: 100 counts, also on the pads 6 and 10 that measure temperature.
  for (int t = 0; t < 12; ++t) {
    EXPECT_NEAR(skin.counts(t, 5 * kSecond_us) - skin.rest_counts(t), 100.0, 1e-9) << t;
    EXPECT_NEAR(skin.counts(t, 60 * kSecond_us) - skin.rest_counts(t), 200.0, 1e-9) << t;
  }
}

TEST(Effects, HumidityMovesPadsWithinItsSpread) {
  Scene scene = scene_of_strip();
  scene.effects.pads.humidity =
      HumidityEffect{.percent = {{0, 40.0}, {kSecond_us, 50.0}}, .counts_per_percent = 10.0, .spread = 0.2};
  const ModuleSkin skin(scene, 1, 0), same(scene, 1, 0);
  double least = 1e9, most = 0.0;
  for (int t = 0; t < 12; ++t) {
    const double change = skin.counts(t, kSecond_us) - skin.rest_counts(t);
    EXPECT_DOUBLE_EQ(change, same.counts(t, kSecond_us) - same.rest_counts(t));
    least = std::min(least, change);
    most = std::max(most, change);
  }
  EXPECT_GE(least, 80.0);
  EXPECT_LE(most, 120.0);
  EXPECT_GT(most - least, 5.0);
}

TEST(Effects, CrosstalkIsAShareOfTheOthers) {
  Scene scene = scene_of_strip();
  scene.pressure = PressureCurve({{0, 2.0}});
  scene.effects.pads.crosstalk = CrosstalkEffect{0.01};
  const ModuleSkin skin(scene, 0, 0);
  // Ten taxels gain 2 kPa · 150 = 300 counts. A taxel has 1 % of the nine others, a temperature pad of all ten.
  EXPECT_NEAR(skin.counts(3, 0) - skin.rest_counts(3), 300.0 + 27.0, 1e-9);
  EXPECT_NEAR(skin.counts(6, 0) - skin.rest_counts(6), 30.0, 1e-9);
}

TEST(Effects, BurstsBeginEndAndRepeat) {
  const std::vector<EmiBurst> bursts = {{kSecond_us, kSecond_us / 2, 2 * kSecond_us, 30.0}, {kSecond_us, 1, 0, 40.0}};
  EXPECT_DOUBLE_EQ(emi_deviation_counts(bursts, kSecond_us - 1), 0.0);
  EXPECT_DOUBLE_EQ(emi_deviation_counts(bursts, kSecond_us), 50.0);  // 30 and 40 add up as squares.
  EXPECT_DOUBLE_EQ(emi_deviation_counts(bursts, kSecond_us + 1), 30.0);
  EXPECT_DOUBLE_EQ(emi_deviation_counts(bursts, kSecond_us + kSecond_us / 2), 0.0);
  EXPECT_DOUBLE_EQ(emi_deviation_counts(bursts, 3 * kSecond_us), 30.0);
  Scene scene = scene_of_strip();
  scene.effects.pads.emi = bursts;
  const ModuleSkin skin(scene, 0, 0);
  EXPECT_DOUBLE_EQ(skin.counts(1, 0), skin.rest_counts(1));
  double square = 0.0;
  constexpr int kSamples = 20'000;
  for (int k = 1; k <= kSamples; ++k) {
    const double x = skin.counts(1, kSecond_us + static_cast<std::uint64_t>(k)) - skin.rest_counts(1);
    square += x * x;
  }
  EXPECT_NEAR(std::sqrt(square / kSamples), 30.0, 0.6);  // The tolerance is four standard errors.
}

// Taxel 0 is 6.533 mm from the middle of a contact of 6 mm, so it feels the contact only through a layer.
TEST(Effects, TheLayerSpreadsAContact) {
  Scene scene = scene_of_strip();
  const design::Vec3 at = center_of(scene.design, 0);
  scene.contacts = {{0, kForever, at, {}, 6.0, 2.0}};
  Skin bare(scene);
  scene.effects.pads.layer = LayerEffect{};
  Skin soft(scene);
  const mechanics::Footprint footprint({2.0, 0.3, 100.0}, 4.0);
  const auto change = [](const Skin& skin, int module, int t) {
    return skin.module(module).counts(t, 0) - skin.module(module).rest_counts(t);
  };
  EXPECT_DOUBLE_EQ(change(bare, 0, 0), 0.0);
  EXPECT_NEAR(change(soft, 0, 3), 2.0 * footprint.kpa_per_newton(6.0, 0.0) * kCountsPerKpa, 1e-6);
  EXPECT_NEAR(change(soft, 0, 0), 2.0 * footprint.kpa_per_newton(6.0, 6.533) * kCountsPerKpa, 1.0);
  EXPECT_GT(change(soft, 0, 0), 200.0) << "the edge of the contact is 0.5 mm away from the taxel's middle";
  EXPECT_DOUBLE_EQ(change(soft, 0, 6), 0.0) << "a temperature pad feels no finger";
}

class EffectFile : public SceneCase {
 protected:
  [[nodiscard]] std::string with(const std::string& effects) const {
    return error_of(R"({"format":"triskin-scene","version":1,"design":"d.json","effects":{)" + effects + "}}");
  }
};

TEST_F(EffectFile, ReadsThem) {
  EXPECT_EQ(with(R"("layer":{},"temperature":{"points":[{"at_s":0,"celsius":20},{"at_s":9,"celsius":35}]},
                    "humidity":{"points":[{"at_s":0,"percent":40}],"spread":0.1},"crosstalk":0.02,
                    "emi":[{"at_s":1,"for_s":0.1,"every_s":1,"counts":50}])"),
            "no error");
  const Scene scene = read_scene(folder_ / "s.json");
  EXPECT_TRUE(scene.effects.pads.act_on_samples());
  EXPECT_DOUBLE_EQ(scene.effects.pads.layer->thickness_mm, 2.0);
  EXPECT_DOUBLE_EQ(scene.effects.pads.temperature->celsius[1].value, 35.0);
  EXPECT_DOUBLE_EQ(scene.effects.pads.humidity->spread, 0.1);
  EXPECT_DOUBLE_EQ(scene.effects.pads.crosstalk->share, 0.02);
  EXPECT_EQ(scene.effects.pads.emi.at(0).every_us, kSecond_us);
}

TEST_F(EffectFile, NamesWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("layer":{"poisson":0.5})", "effects.layer.poisson"},
      {R"("layer":{"depth_mm":2})", "key \"depth_mm\" is unknown"},
      {R"("temperature":{"points":[]})", "give at least one"},
      {R"("temperature":{"points":[{"at_s":2,"celsius":20},{"at_s":1,"celsius":20}]})", "is earlier than"},
      {R"("humidity":{"points":[{"at_s":0,"percent":120}]})", "effects.humidity.points[0].percent"},
      {R"("crosstalk":2)", "effects.crosstalk"},
      {R"("emi":[{"for_s":2,"every_s":1,"counts":5}])", "would never end"},
      {R"("emi":[{"counts":5}])", "for_s"},
  };
  for (const auto& [effects, expected] : cases)
    EXPECT_NE(with(effects).find(expected), std::string::npos) << effects << " -> " << with(effects);
}

}  // namespace
}  // namespace triskin::scene
