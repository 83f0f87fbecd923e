// SPDX-License-Identifier: GPL-3.0-or-later
// These tests compare the effects of the surroundings on the pads with values worked by hand.
#include "triskin/hardware/effects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene_case.hpp"
#include "triskin/hardware/skin.hpp"

namespace triskin::hardware {
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
  const ModuleSkin skin(scene, layout::ModuleId{0}, 0);
  // After 5 s the pads are 5 degrees warmer: 100 counts, also on the pads 6 and 10 that measure temperature.
  for (int t = 0; t < 12; ++t) {
    EXPECT_NEAR(skin.counts(t, 5 * kSecond_us) - skin.rest_counts(layout::TaxelIndex{t}), 100.0, 1e-9) << t;
    EXPECT_NEAR(skin.counts(t, 60 * kSecond_us) - skin.rest_counts(layout::TaxelIndex{t}), 200.0, 1e-9) << t;
  }
}

TEST(Effects, HumidityMovesPadsWithinItsSpread) {
  Scene scene = scene_of_strip();
  scene.effects.pads.humidity =
      HumidityEffect{.percent = {{0, 40.0}, {kSecond_us, 50.0}}, .counts_per_percent = 10.0, .spread = 0.2};
  const ModuleSkin skin(scene, layout::ModuleId{1}, 0), same(scene, layout::ModuleId{1}, 0);
  double least = 1e9, most = 0.0;
  for (int t = 0; t < 12; ++t) {
    const double change = skin.counts(t, kSecond_us) - skin.rest_counts(layout::TaxelIndex{t});
    EXPECT_DOUBLE_EQ(change, same.counts(t, kSecond_us) - same.rest_counts(layout::TaxelIndex{t}));
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
  const ModuleSkin skin(scene, layout::ModuleId{0}, 0);
  // Ten taxels gain 2 kPa · 10 = 20 counts. A taxel has 1 % of the nine others, a temperature pad of all ten.
  EXPECT_NEAR(skin.counts(3, 0) - skin.rest_counts(layout::TaxelIndex{3}), 20.0 + 1.8, 1e-9);
  EXPECT_NEAR(skin.counts(6, 0) - skin.rest_counts(layout::TaxelIndex{6}), 2.0, 1e-9);
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
  const ModuleSkin skin(scene, layout::ModuleId{0}, 0);
  EXPECT_DOUBLE_EQ(skin.counts(1, 0), skin.rest_counts(layout::TaxelIndex{1}));
  double square = 0.0;
  constexpr int kSamples = 20'000;
  for (int k = 1; k <= kSamples; ++k) {
    const double x =
        skin.counts(1, kSecond_us + static_cast<std::uint64_t>(k)) - skin.rest_counts(layout::TaxelIndex{1});
    square += x * x;
  }
  EXPECT_NEAR(std::sqrt(square / kSamples), 30.0, 0.6);  // The tolerance is four standard errors.
}

// Taxel 0 is 6.533 mm from the middle of a contact of 6 mm, so it feels the contact only through a layer.
TEST(Effects, TheLayerSpreadsAContact) {
  Scene scene = scene_of_strip();
  const design::Vec3 at = center_of(scene.design, layout::ModuleId{0});
  scene.contacts = {{0, kForever, at, {}, 6.0, 2.0}};
  Skin bare(scene);
  scene.effects.pads.layer = LayerEffect{};
  Skin soft(scene);
  const mechanics::Footprint footprint({2.0, 0.3, 100.0}, 4.0);
  const auto change = [](const Skin& skin, int module, int t) {
    return skin.module(layout::ModuleId{module}).counts(t, 0) -
           skin.module(layout::ModuleId{module}).rest_counts(layout::TaxelIndex{t});
  };
  EXPECT_DOUBLE_EQ(change(bare, 0, 0), 0.0);
  EXPECT_NEAR(change(soft, 0, 3), 2.0 * footprint.kpa_per_newton(6.0, 0.0) * kCountsPerKpa, 1e-6);
  EXPECT_NEAR(change(soft, 0, 0), 2.0 * footprint.kpa_per_newton(6.0, 6.533) * kCountsPerKpa, 0.1);
  EXPECT_GT(change(soft, 0, 0), 20.0) << "the edge of the contact is 0.5 mm away from the taxel's middle";
  EXPECT_DOUBLE_EQ(change(soft, 0, 6), 0.0) << "a temperature pad feels no finger";
}

// The cable feeds module 0, 0 feeds 1, and 1 feeds 2 and 3; each module draws 10 mA, the cable has 1 Ω, a joint 2 Ω.
design::Patch forked_patch() {
  design::Patch patch;
  for (const auto& [node, parent] : {std::pair(0, -1), std::pair(1, 0), std::pair(2, 1), std::pair(3, 1)})
    patch.modules.push_back({.node = node, .parent = parent});
  return patch;
}

TEST(Effects, SupplyDropsAlongTheTree) {
  const SupplyEffect supply{.volts = {}, .cable_ohm = 1.0, .joint_ohm = 2.0, .module_ma = 10.0};
  const std::vector<double> drops_v = supply_drops_v(supply, forked_patch());
  const double expected_v[] = {0.04, 0.04 + 0.06, 0.10 + 0.02, 0.10 + 0.02};  // 4 modules · 10 mA · 1 Ω, and so on.
  ASSERT_EQ(drops_v.size(), std::size(expected_v));
  for (std::size_t k = 0; k < drops_v.size(); ++k) EXPECT_NEAR(drops_v[k], expected_v[k], 1e-12) << k;
}

TEST(Effects, AModuleIsOutWhileItsVoltageIsTooLow) {
  SupplyEffect supply;  // The chips need 2.6 V.
  supply.volts = {{0, 3.3}, {kSecond_us, 2.3}, {2 * kSecond_us, 3.3}};
  const auto outages = outages_of(supply, 0.1);  // The line reaches 2.7 V after 0.6 s, and again after 1.4 s.
  ASSERT_EQ(outages.size(), 1U);
  EXPECT_EQ(outages[0].from_us, 600'000U);
  EXPECT_EQ(outages[0].until_us, 1'400'000U);
  EXPECT_TRUE(outages_of({.volts = {{0, 3.3}}}, 0.69).empty());
  const auto always = outages_of({.volts = {{0, 3.3}}}, 0.71);
  ASSERT_EQ(always.size(), 1U);
  EXPECT_EQ(always[0].from_us, 0U);
  EXPECT_EQ(always[0].until_us, Ad7147::kNever);
}

void write_register(I2cLineModel& line, int address, std::uint16_t at, std::uint16_t value, std::uint64_t now_us) {
  ASSERT_TRUE(line.start(static_cast<std::uint8_t>(address << 1), now_us));
  for (const int byte : {at >> 8, at & 0xFF, value >> 8, value & 0xFF})
    line.write(static_cast<std::uint8_t>(byte), now_us);
  line.stop(now_us);
}

std::uint16_t read_register(I2cLineModel& line, int address, std::uint16_t at, std::uint64_t now_us) {
  line.start(static_cast<std::uint8_t>(address << 1), now_us);
  for (const int byte : {at >> 8, at & 0xFF}) line.write(static_cast<std::uint8_t>(byte), now_us);
  line.start(static_cast<std::uint8_t>(address << 1 | 1), now_us);
  const int high = line.read(true, now_us), low = line.read(false, now_us);
  line.stop(now_us);
  return static_cast<std::uint16_t>(high << 8 | low);
}

// The far module of a strip of two browns out at 2.6 V + 0.3 V: it is silent and comes back without its configuration.
TEST(Effects, OnlyTheFarModuleBrownsOut) {
  Scene scene = scene_of_strip();
  SupplyEffect supply{.volts = {}, .cable_ohm = 0.0, .joint_ohm = 100.0, .module_ma = 3.0};
  supply.volts = {{0, 3.3}, {kSecond_us, 3.3}, {kSecond_us, 2.8}, {2 * kSecond_us, 2.8}, {2 * kSecond_us, 3.3}};
  scene.effects.pads.supply = supply;
  Skin skin(scene);
  const design::Patch& patch = scene.design.patches.front();
  constexpr std::uint16_t kCalibrationEnable = 0x001;
  for (const design::RoutedModule& m : patch.modules) {
    const bool is_far = m.parent >= 0;
    I2cLineModel& line = skin.line(layout::PatchIndex{0}, m.line);
    const int address = layout::cdc_address(m.address);
    const auto acknowledges = [&](std::uint64_t at_us) {
      const bool is_there = line.start(static_cast<std::uint8_t>(address << 1), at_us);
      line.stop(at_us);
      return is_there;
    };
    write_register(line, address, kCalibrationEnable, 0x0FFF, 0);
    EXPECT_TRUE(acknowledges(kSecond_us - 1));
    EXPECT_EQ(acknowledges(kSecond_us), !is_far);
    EXPECT_EQ(acknowledges(2 * kSecond_us - 1), !is_far);
    EXPECT_TRUE(acknowledges(2 * kSecond_us));
    EXPECT_EQ(read_register(line, address, kCalibrationEnable, 2 * kSecond_us), is_far ? 0 : 0x0FFF);
  }
}

// ln(1/0.3) · 1 kΩ · 500 pF = 0.602 µs.
TEST(Effects, ALineRisesWithItsCapacitance) {
  EXPECT_NEAR(rise_to_high_us({.pull_up_ohm = 1000.0, .extra_pf = 100.0}, 400.0), 0.602, 0.001);
}

// The line of the near module has 100 pF and the far module's 400 pF. With 2.2 kΩ they reach the high level after 0.26
// and 1.06 µs, with 4.7 kΩ after 0.57 and 2.26 µs; a bit has 1.2 µs.
TEST(Effects, ALineThatRisesTooSlowlyIsSilent) {
  Scene scene = scene_of_strip();
  design::Patch& patch = scene.design.patches.front();
  patch.modules.at(1).line = (patch.modules.at(0).line + 1) % 4;
  patch.lines.assign(4, {});
  patch.lines[static_cast<std::size_t>(patch.modules[0].line)].capacitance_pf = 100.0;
  patch.lines[static_cast<std::size_t>(patch.modules[1].line)].capacitance_pf = 400.0;
  for (const double ohm : {2200.0, 4700.0}) {
    scene.effects.pads.edges = EdgeEffect{.pull_up_ohm = ohm};
    Skin skin(scene);
    for (const std::size_t k : {0U, 1U}) {
      const design::RoutedModule& m = patch.modules[k];
      const auto address = static_cast<std::uint8_t>(layout::cdc_address(m.address) << 1);
      EXPECT_EQ(skin.line(layout::PatchIndex{0}, m.line).start(address, 1000), k == 0 || ohm == 2200.0)
          << ohm << " ohm, module " << k;
    }
  }
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
                    "supply":{"points":[{"at_s":0,"volts":3.3}],"joint_ohm":0.5},
                    "edges":{"pull_up_ohm":2200,"extra_pf":150},
                    "emi":[{"at_s":1,"for_s":0.1,"every_s":1,"counts":50}])"),
            "no error");
  const Scene scene = read_scene(folder_ / "s.json");
  EXPECT_TRUE(scene.effects.pads.act_on_samples());
  EXPECT_DOUBLE_EQ(scene.effects.pads.layer->thickness_mm, 2.0);
  EXPECT_DOUBLE_EQ(scene.effects.pads.temperature->celsius[1].value, 35.0);
  EXPECT_DOUBLE_EQ(scene.effects.pads.humidity->spread, 0.1);
  EXPECT_DOUBLE_EQ(scene.effects.pads.crosstalk->share, 0.02);
  EXPECT_DOUBLE_EQ(scene.effects.pads.supply->joint_ohm, 0.5);
  EXPECT_DOUBLE_EQ(scene.effects.pads.edges->extra_pf, 150.0);
  EXPECT_DOUBLE_EQ(scene.effects.pads.edges->settling_us, 1.2);
  EXPECT_EQ(scene.effects.pads.emi.at(0).every_us, kSecond_us);
}

TEST_F(EffectFile, NamesWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {R"("layer":{"poisson":0.5})", "/effects/layer/poisson"},
      {R"("layer":{"depth_mm":2})", "key \"depth_mm\" is unknown"},
      {R"("temperature":{"points":[]})", "give at least one"},
      {R"("temperature":{"points":[{"at_s":2,"celsius":20},{"at_s":1,"celsius":20}]})", "is earlier than"},
      {R"("humidity":{"points":[{"at_s":0,"percent":120}]})", "/effects/humidity/points/0/percent"},
      {R"("crosstalk":2)", "/effects/crosstalk"},
      {R"("supply":{"joint_ohm":1})", "points"},
      {R"("supply":{"points":[{"at_s":0,"volts":33}]})", "/effects/supply/points/0/volts"},
      {R"("supply":{"points":[{"at_s":0,"volts":3.3}],"cable_ohm":-1})", "/effects/supply/cable_ohm"},
      {R"("edges":{"pull_up_ohm":0})", "/effects/edges/pull_up_ohm"},
      {R"("edges":{"extra_nf":1})", "key \"extra_nf\" is unknown"},
      {R"("emi":[{"for_s":2,"every_s":1,"counts":5}])", "would never end"},
      {R"("emi":[{"counts":5}])", "for_s"},
  };
  for (const auto& [effects, expected] : cases)
    EXPECT_NE(with(effects).find(expected), std::string::npos) << effects << " -> " << with(effects);
}

}  // namespace
}  // namespace triskin::hardware
