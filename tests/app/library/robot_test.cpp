// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a robot of two covers on two buses through the C interface: simulated in this process, and served.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/child_process.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/triskin.h"

namespace triskin {
namespace {

namespace fs = std::filesystem;

// Cover arm has 8 modules on two controllers, 100 mm up; cover leg has 6 modules on two, 500 mm aside.
class RobotSkin : public testing::Test {
 protected:
  RobotSkin() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    ::setenv("XDG_STATE_HOME", folder_.c_str(), 1);
    design::write_design(folder_ / "arm.json", test::strip(8, 4));
    design::write_design(folder_ / "leg.json", test::with_gaps(test::strip(6, 3)));
    run("robot new robot.json --name demo --bus left=sim --bus right=sim");
    run("robot add robot.json arm.json --name arm --bus left --xyz-mm 0,0,100");
    run("robot add robot.json leg.json --name leg --bus right --xyz-mm 0,500,0");
    run("flash robot.json");
  }
  ~RobotSkin() override {
    triskin_close(skin_);
    fs::remove_all(folder_);
  }
  void run(const std::string& arguments) const {
    const std::string line =
        fmt::format("cd '{}' && '{}' {} > /dev/null 2>&1", folder_.string(), test::program_file(), arguments);
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
  }
  void open(const char* link) {
    triskin_options options = TRISKIN_OPTIONS_INIT;
    options.link = link;
    ASSERT_EQ(triskin_open((folder_ / "robot.json").c_str(), &options, &skin_), TRISKIN_OK) << triskin_error();
  }
  // All modules must give every sample, whatever their bus.
  void read_some() const {
    std::map<int, std::set<std::uint32_t>> numbers;
    std::map<int, int> nodes;
    std::vector<triskin_sample> samples(10'000);
    const double end_s = triskin_now_s(skin_) + 1.5;
    while (triskin_now_s(skin_) < end_s) {
      std::size_t n = 0;
      ASSERT_EQ(triskin_read(skin_, 0.1, samples.data(), samples.size(), &n), TRISKIN_OK) << triskin_error();
      for (std::size_t k = 0; k < n; ++k) {
        EXPECT_TRUE(numbers[samples[k].module].insert(samples[k].number).second);
        nodes[samples[k].module] = samples[k].node;
      }
    }
    ASSERT_EQ(numbers.size(), 14U);
    for (const auto& [module, of] : numbers) {
      EXPECT_GT(of.size(), 10U) << module;
      EXPECT_EQ(of.size(), *of.rbegin() - *of.begin() + 1) << module;
    }
    EXPECT_EQ(nodes[7], 2);
    EXPECT_EQ(nodes[8], 1);  // This is the first of the other bus.
    EXPECT_EQ(nodes[13], 2);
    ASSERT_EQ(triskin_stop(skin_), TRISKIN_OK);
    triskin_counts counts{};
    ASSERT_EQ(triskin_get_counts(skin_, &counts), TRISKIN_OK);
    EXPECT_EQ(counts.lost, 0U);
    EXPECT_EQ(counts.expected, counts.received);
    EXPECT_GE(counts.received, 14U * 10U);
  }
  const fs::path folder_ = fs::temp_directory_path() / ("library_robot." + std::to_string(::getpid()));
  triskin_skin* skin_ = nullptr;
};

TEST_F(RobotSkin, has_all_covers_in_the_frame_of_the_base) {
  open(nullptr);
  ASSERT_EQ(triskin_module_count(skin_), 14U);
  ASSERT_EQ(triskin_cover_count(skin_), 2U);
  EXPECT_STREQ(triskin_cover_name(skin_, 0), "arm");
  EXPECT_STREQ(triskin_cover_name(skin_, 1), "leg");
  EXPECT_STREQ(triskin_cover_name(skin_, 2), "");
  std::vector<std::int32_t> covers(14), patches(14), numbers(14);
  ASSERT_EQ(triskin_module_numbers(skin_, numbers.data(), numbers.size()), TRISKIN_OK);
  EXPECT_EQ(numbers, (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 12}));
  ASSERT_EQ(triskin_covers(skin_, covers.data(), covers.size()), TRISKIN_OK);
  EXPECT_EQ(covers, (std::vector<std::int32_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}));
  ASSERT_EQ(triskin_patches(skin_, patches.data(), patches.size()), TRISKIN_OK);
  EXPECT_EQ(patches, (std::vector<std::int32_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 4, 4, 4}));
  std::vector<double> places_mm(std::size_t{14} * 36);
  ASSERT_EQ(triskin_positions_mm(skin_, places_mm.data(), places_mm.size()), TRISKIN_OK);
  const design::Design leg = test::strip(6, 3);
  const auto poses = design::taxels_of(leg.layout.modules[2], design::wiring_of(leg)[2].routed.rotation);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(places_mm[(10 * 12 + 4) * 3 + axis],
                poses[4].position_mm[static_cast<int>(axis)] + (axis == 1 ? 500.0 : 0.0), 1e-9);
  }
  EXPECT_NEAR(places_mm[2], 100.0, 1e-9);
}

TEST_F(RobotSkin, reads_tares_and_verifies_in_virtual_time) {
  open(nullptr);
  read_some();
  const char* report = nullptr;
  EXPECT_EQ(triskin_verify(skin_, &report), TRISKIN_OK) << triskin_error();
  ASSERT_NE(report, nullptr);
  EXPECT_NE(std::string(report).find("cover arm\n"), std::string::npos) << report;
  EXPECT_NE(std::string(report).find("cover leg\n"), std::string::npos) << report;
  ASSERT_EQ(triskin_tare(skin_), TRISKIN_OK) << triskin_error();
  std::vector<double> change_counts(std::size_t{14} * 12, 1.0);
  ASSERT_EQ(triskin_change_counts(skin_, change_counts.data(), change_counts.size()), TRISKIN_OK);
  for (const double c : change_counts) EXPECT_LT(c, 100.0);
}

TEST_F(RobotSkin, reads_two_served_buses_by_a_thread_each) {
  const test::ServedSimulation served((folder_ / "robot.json").string());
  ASSERT_NE(served.link(), "");
  open(served.link().c_str());
  read_some();
}

TEST_F(RobotSkin, refuses_what_cannot_be) {
  triskin_options options = TRISKIN_OPTIONS_INIT;
  options.link = "can:none";
  EXPECT_EQ(triskin_open((folder_ / "robot.json").c_str(), &options, &skin_), TRISKIN_BAD_INPUT);
  const std::string said = triskin_error();
  EXPECT_NE(said.find("link=\"can:none\": "), std::string::npos) << said;
  EXPECT_NE(said.find("its file names their links"), std::string::npos) << said;
  EXPECT_EQ(said.find("--"), std::string::npos) << "an option of the program is no argument of a function: " << said;
  run("robot new mixed.json --name mixed --bus left=sim --bus right=sim:127.0.0.1:1");
  run("robot add mixed.json arm.json --name arm --bus left");
  run("robot add mixed.json leg.json --name leg --bus right");
  EXPECT_EQ(triskin_open((folder_ / "mixed.json").c_str(), nullptr, &skin_), TRISKIN_BAD_INPUT);
  EXPECT_NE(std::string(triskin_error()).find("some buses are simulated in this process"), std::string::npos)
      << triskin_error();
}

}  // namespace
}  // namespace triskin
