// SPDX-License-Identifier: GPL-3.0-or-later
// Skins whose converters are drawn from the whole of their ranges: taxels rest up to thousands of counts off the
// middle, and what rests is told apart from what is pressed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "support/strip_design.hpp"
#include "support/temp_folder.hpp"
#include "triskin/deploy/flash.hpp"
#include "triskin/diagnose/verify.hpp"
#include "triskin/layout/rest.hpp"
#include "triskin/session/patch_offsets.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::skin {
namespace {

using testing::IsEmpty;

constexpr int kModules = 16, kPressed = 5, kTaxel = 3;
constexpr std::uint64_t kSecond_us = 1'000'000;

// One board with a strip of sixteen modules. Its controller has found its offsets in an earlier session.
class DrawnSkin {
 public:
  DrawnSkin(int seed, const std::string& more, const std::string& converters = "\"drawn\"") {
    ::setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
    const design::Design design = test::strip(kModules);
    design::write_design(folder_ / "strip.json", design);
    const std::string scene_file = folder_ / "scene.json";
    std::ofstream(scene_file) << fmt::format(
        R"({{"format":"triskin-scene","version":1,"design":"strip.json","seed":{},"converters":{}{}}})", seed,
        converters, more);
    link_.scene = scene_file;
    {
      const auto link = connect::open_link(link_, &design);
      session::Bus bus(*link);
      (void)deploy::flash(bus, design, {});
      bus.listen(bus.now_us() + 2 * kSecond_us);
    }
    skin_.emplace(robot::read_site((folder_ / "strip.json")), link_);
    skin_->open();
  }
  [[nodiscard]] LiveBus& bus() { return *skin_->buses().front(); }
  [[nodiscard]] LiveMonitor& monitor() { return bus().covers().front().monitor(); }
  // The program starts at this time after power-up.
  void start_live(std::uint64_t at_us) {
    bus().bus().listen(at_us);
    bus().find_controllers();
    bus().start({}, {});
  }
  void pass_until(std::uint64_t us) { bus().run({.until_us = us}); }
  // Returns the change of the pressed taxel, or 0 when no taxel is pressed. Others may be pressed only around it.
  double pressed_counts() {
    double counts = 0.0;
    for (const PressedTaxel& p : monitor().touches().pressed()) {
      EXPECT_LE(std::abs(p.module - kPressed), 1) << "taxel " << p.taxel;
      if (p.module == kPressed && p.taxel == kTaxel) counts = p.change_counts;
    }
    return counts;
  }
  [[nodiscard]] int rest_off_the_middle() {
    int off = 0;
    for (const auto& module : session::settled_rest(bus().bus(), bus().covers().front().design(), bus().claims())) {
      for (const double counts : module) off += std::abs(counts - layout::kRestCounts) > 1'800.0 ? 1 : 0;
    }
    return off;
  }
  std::vector<diagnose::Finding> verify() {
    bus().finish();
    return diagnose::verify(bus().bus(), bus().covers().front().design(), {}).findings;
  }

 private:
  test::TempFolder folder_;
  connect::LinkOptions link_{.link = "sim", .chosen = true, .scene = "", .own_interrupts = false};
  std::optional<LiveSkin> skin_;
};

// A finger of 4 N on a radius of 6 mm presses the taxel at its centre with 53 kPa: 531 counts.
std::string fingers(const std::vector<std::pair<double, double>>& times_s) {
  std::string all;
  for (const auto& [from_s, until_s] : times_s)
    all += fmt::format(R"({}{{"module":{},"taxel":{},"force_n":4,"at_s":{},"until_s":{}}})", all.empty() ? "" : ",",
                       kPressed, kTaxel, from_s, until_s);
  return ",\"contacts\":[" + all + "]";
}
// With a converter of gain 1. The gain is a property that a scene can fix while all others are drawn: gain and finger
// are known then, and what is left is a rest value within the noise of three samples and the gains of inputs and
// stages.
constexpr double kFinger_counts = 531.0, kTolerance = 0.1;
double gain_of(int seed) {
  return std::array{1.0, 0.75, 1.25}[static_cast<std::size_t>(seed) % 3];
}
std::string with_gain(int seed) {
  return fmt::format(R"({{"gain":{}}})", gain_of(seed));
}

// Half of the programs start with the controllers, the others when humidity has moved taxels by up to 160 counts
// against their pads.
TEST(DrawnSkins, untouched_ones_show_no_contact_and_no_finding) {
  constexpr int kSkins = 60;
  int off_middle = 0;
  for (int seed = 1; seed <= kSkins; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const bool late = seed % 2 == 0;
    DrawnSkin skin(
        seed, late ? R"(,"effects":{"humidity":{"points":[{"at_s":2,"percent":30},{"at_s":3,"percent":70}]}})" : "");
    const std::uint64_t start_us = late ? 4 * kSecond_us : 0;
    skin.start_live(start_us);
    for (int step = 1; step <= 10; ++step) {
      skin.pass_until(start_us + static_cast<std::uint64_t>(step) * 200'000);
      EXPECT_THAT(skin.monitor().touches().pressed(), IsEmpty());
      EXPECT_EQ(skin.monitor().off_rest().taxels, 0);
    }
    EXPECT_EQ(skin.monitor().unheard(layout::PatchIndex{0}), 0);
    off_middle += skin.rest_off_the_middle();
    for (const diagnose::Finding& f : skin.verify()) ADD_FAILURE() << f.text;
  }
  EXPECT_GT(off_middle, 0) << "the ranges have electrodes that no offset cancels";
}

TEST(DrawnSkins, a_finger_that_came_before_the_program_is_a_contact) {
  for (int seed = 101; seed <= 115; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    DrawnSkin skin(seed, fingers({{3, 6}, {8, 9}}), with_gain(seed));
    const double counts = kFinger_counts * gain_of(seed);
    skin.start_live(4 * kSecond_us);
    skin.pass_until(5 * kSecond_us);
    EXPECT_NEAR(skin.pressed_counts(), counts, kTolerance * counts);
    skin.pass_until(7 * kSecond_us);
    EXPECT_THAT(skin.monitor().touches().pressed(), IsEmpty());
    skin.pass_until(8'500'000);
    EXPECT_NEAR(skin.pressed_counts(), counts, kTolerance * counts);
  }
}

// Nobody can know it while it lasts; it leaves no ghost, and the next touch counts in full.
TEST(DrawnSkins, a_finger_at_power_up_shows_after_it_was_lifted) {
  for (int seed = 201; seed <= 215; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    DrawnSkin skin(seed, fingers({{0, 6}, {8, 9}}), with_gain(seed));
    const double counts = kFinger_counts * gain_of(seed);
    skin.start_live(seed % 2 == 0 ? 4 * kSecond_us : 0);
    skin.pass_until(5 * kSecond_us);
    EXPECT_THAT(skin.monitor().touches().pressed(), IsEmpty());
    skin.pass_until(7 * kSecond_us);
    EXPECT_THAT(skin.monitor().touches().pressed(), IsEmpty());
    EXPECT_EQ(skin.monitor().off_rest().taxels, 0);
    skin.pass_until(8'500'000);
    EXPECT_NEAR(skin.pressed_counts(), counts, kTolerance * counts);
    EXPECT_THAT(skin.verify(), IsEmpty());
  }
}

}  // namespace
}  // namespace triskin::skin
