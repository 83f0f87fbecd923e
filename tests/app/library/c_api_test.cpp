// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "flashed_sim.hpp"
#include "triskin/triskin.h"

namespace triskin {
namespace {

using test::FlashedSim;

// The pressure in the middle of the scene's contact, 1 N and 3 mm, is 3F/(2πr²), at 10 counts/kPa (docs/scene.md).
const double kMiddle_counts = 3.0 / (2.0 * std::numbers::pi * 9e-6) * 1e-3 * 10.0;

class Open {
 public:
  explicit Open(const FlashedSim& sim, const std::string& link = "sim") : scene_(sim.scene_file()) {
    triskin_options options = TRISKIN_OPTIONS_INIT;
    options.link = link.c_str();
    options.scene = scene_.c_str();
    EXPECT_EQ(triskin_open(sim.design_file().c_str(), &options, &skin_), TRISKIN_OK) << triskin_error();
  }
  ~Open() { triskin_close(skin_); }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;
  operator triskin_skin*() const { return skin_; }
  [[nodiscard]] std::vector<triskin_sample> read(double until_s) const {
    std::vector<triskin_sample> all(100'000);
    std::size_t n = 0;
    const double end_s = triskin_now_s(skin_) + until_s;
    while (triskin_now_s(skin_) < end_s) {
      std::size_t count = 0;
      EXPECT_EQ(triskin_read(skin_, 0.1, all.data() + n, all.size() - n, &count), TRISKIN_OK) << triskin_error();
      n += count;
    }
    all.resize(n);
    return all;
  }

 private:
  std::string scene_;
  triskin_skin* skin_ = nullptr;
};

TEST(Library, reads_every_sample_with_time_and_place) {
  const FlashedSim sim;
  const Open skin(sim);
  ASSERT_EQ(triskin_module_count(skin), 8U);
  const auto samples = skin.read(2.0);
  std::map<int, std::uint32_t> newest;
  for (const triskin_sample& s : samples) {
    if (newest.contains(s.module)) {
      ASSERT_EQ(s.number, newest[s.module] + 1) << "module " << s.module;
    }
    newest[s.module] = s.number;
    EXPECT_EQ(s.node, s.module / 4 + 1);
    EXPECT_LT(s.error_s, 0.05);
  }
  EXPECT_EQ(newest.size(), 8U);
  ASSERT_EQ(triskin_stop(skin), TRISKIN_OK);
  triskin_counts counts{};
  ASSERT_EQ(triskin_get_counts(skin, &counts), TRISKIN_OK);
  EXPECT_EQ(counts.lost, 0U);
  EXPECT_EQ(counts.lost_here, 0U);
  EXPECT_EQ(counts.expected, counts.received);
  EXPECT_GE(counts.received, samples.size());
  std::vector<triskin_sample> rest(1000);
  std::size_t waiting = 0;
  ASSERT_EQ(triskin_read(skin, 0.0, rest.data(), rest.size(), &waiting), TRISKIN_OK);
  EXPECT_EQ(samples.size() + waiting, counts.received);
}

TEST(Library, gives_positions_of_the_design_and_pressure_of_the_scene) {
  const FlashedSim sim;
  const Open skin(sim);
  std::vector<double> places_mm(std::size_t{8} * 36), change_counts(std::size_t{8} * 12);
  ASSERT_EQ(triskin_positions_mm(skin, places_mm.data(), places_mm.size()), TRISKIN_OK);
  const auto poses =
      design::taxels_of(sim.design().layout.modules[5], design::wiring_of(sim.design())[5].routed.rotation);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_EQ(places_mm[(5 * 12 + 3) * 3 + axis], poses[3].position_mm[static_cast<int>(axis)]);
  ASSERT_EQ(triskin_tare(skin), TRISKIN_OK) << triskin_error();
  (void)skin.read(7.0);
  ASSERT_EQ(triskin_change_counts(skin, change_counts.data(), change_counts.size()), TRISKIN_OK);
  // The gain of the negative input is off by up to 2.2 %, that of a stage by 0.2 % (docs/silicon.md).
  EXPECT_NEAR(change_counts[5 * 12 + 3], kMiddle_counts, 0.024 * kMiddle_counts);
  // A converter reads up to 2 counts beside its value (docs/silicon.md), at the tare and now.
  EXPECT_LE(std::abs(change_counts[2 * 12 + 3]), 4.0);
}

TEST(Library, says_what_was_wrong) {
  const FlashedSim sim;
  triskin_skin* skin = nullptr;
  EXPECT_EQ(triskin_open("/no/such/file.json", nullptr, &skin), TRISKIN_BAD_INPUT);
  EXPECT_EQ(skin, nullptr);
  EXPECT_NE(std::string(triskin_error()).find("/no/such/file.json"), std::string::npos);
  triskin_options options = TRISKIN_OPTIONS_INIT;
  options.link = "sim:127.0.0.1:1";
  EXPECT_EQ(triskin_open(sim.design_file().c_str(), &options, &skin), TRISKIN_DEVICE_FAILED);
  EXPECT_NE(std::string(triskin_error()).find("triskin simulate"), std::string::npos) << triskin_error();
  const Open open(sim);
  double one = 0.0;
  EXPECT_EQ(triskin_normals(open, &one, 1), TRISKIN_BAD_INPUT);
  EXPECT_STREQ(triskin_error(), "triskin_normals: n is 1, must be 288");
}

TEST(Library, verifies_and_names_what_is_missing) {
  const FlashedSim sim(R"([{"kind":"removed_chip","module":6}])");
  const Open skin(sim);
  const char* report = nullptr;
  EXPECT_EQ(triskin_verify(skin, &report), TRISKIN_BAD_ANSWER);
  ASSERT_NE(report, nullptr);
  EXPECT_NE(std::string(report).find("module 6"), std::string::npos) << report;
}

// The serial numbers of simulated boards follow from the design, so that they are in the order of the patches for about
// one design in two, and boards that are taken in this order would pass for those only.
TEST(Library, flashes_each_simulated_board_with_the_tables_of_its_patch) {
  const FlashedSim sim;
  for (const auto& [modules, per_patch] :
       {std::pair{5, 3}, {7, 4}, {8, 4}, {9, 5}, {10, 5}, {11, 6}, {12, 4}, {14, 7}}) {
    const std::string file = sim.folder() / "two.json";
    design::write_design(file, test::strip(modules, per_patch));
    ASSERT_EQ(triskin_flash_simulation(file.c_str()), TRISKIN_OK) << triskin_error();
    triskin_options options = TRISKIN_OPTIONS_INIT;
    options.link = "sim";
    triskin_skin* skin = nullptr;
    ASSERT_EQ(triskin_open(file.c_str(), &options, &skin), TRISKIN_OK) << triskin_error();
    const char* report = nullptr;
    EXPECT_EQ(triskin_verify(skin, &report), TRISKIN_OK) << modules << " modules\n" << report;
    triskin_close(skin);
  }
}

}  // namespace
}  // namespace triskin
