// SPDX-License-Identifier: GPL-3.0-or-later
// Tests jumpers on switched modules with the commands flash, verify and discover --topology, as processes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/jumpered_design.hpp"
#include "support/random_design.hpp"
#include "support/switched_case.hpp"

namespace triskin::pipeline {
namespace {

using nlohmann::json;

class JumperedHardware : public test::SwitchedCase {
 protected:
  void SetUp() override {
    SwitchedCase::SetUp();
    scene(json::array());
  }
  design::Design make_design() override {
    std::mt19937_64 random(8);
    return test::jumpered_design(8, 6, random);
  }
  // Returns what a controller can still read with the jumper open.
  [[nodiscard]] int survivors() const {
    const auto row = [&](int node) {
      return static_cast<int>(std::ranges::find(design_.patches[0].modules, node, &design::RoutedModule::node) -
                              design_.patches[0].modules.begin());
    };
    const design::Jumper& j = design_.layout.jumpers[0];
    return std::popcount(test::rows_that_survive(design_, {{}, {{row(j.node[0]), row(j.node[1])}}}));
  }
};

TEST_F(JumperedHardware, sound_hardware_is_the_design) {
  ASSERT_EQ(design_.patches.size(), 1U);
  ASSERT_EQ(design_.layout.jumpers.size(), 1U);
  run("flash patch.json --scene scene.json", 0);
  const json found = run("discover --topology --scene scene.json --design patch.json", 0);
  EXPECT_TRUE(found["controllers"][0]["topology"]["match"]["differences"].empty());
  const json verified = run("verify patch.json --scene scene.json --watch-s 0", 0);
  EXPECT_EQ(verified["modules_ok"], 14);
  EXPECT_TRUE(verified["findings"].empty());
}

TEST_F(JumperedHardware, an_open_jumper_is_found_and_the_rest_is_read) {
  run("flash patch.json --scene scene.json", 0);
  const design::Jumper& j = design_.layout.jumpers[0];
  scene({{{"kind", "open_joint"}, {"module", j.node[0]}, {"other", j.node[1]}}});
  const json verified = run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 1);
  EXPECT_EQ(verified["modules_ok"], survivors());
  const json found = run("discover --topology --scene scene.json --design patch.json", 1);
  EXPECT_FALSE(found["controllers"][0]["topology"]["match"]["differences"].empty());
}

TEST_F(JumperedHardware, a_fault_of_a_jumper_that_is_not_there_is_refused) {
  const int a = design_.layout.jumpers[0].node[0];
  int stranger = a;  // This module of the other island has no jumper to a.
  for (int k = 0; k < 14; ++k) {
    if (std::ranges::count(design::joined_to(design_.layout, a), k) == 0 && k != a) stranger = k;
  }
  scene({{{"kind", "open_joint"}, {"module", a}, {"other", stranger}}});
  run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 2);
}

}  // namespace
}  // namespace triskin::pipeline
