// SPDX-License-Identifier: GPL-3.0-or-later
// Runs what a technician types: flash, discover --topology, flash --route and verify on switched modules, as processes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/random_design.hpp"
#include "support/switched_case.hpp"
#include "triskin/design/joint.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;

class Commands : public SwitchedCase {
 protected:
  design::Design make_design() override {
    std::mt19937_64 random(41);
    const design::Design own = random_design(12, random);
    design::write_design(folder_ / "other.json", random_design(12, random));
    return own;
  }
  static std::vector<std::string> kinds(const json& list) {
    std::vector<std::string> out;
    for (const json& d : list) out.push_back(d["kind"]);
    return out;
  }
};

TEST_F(Commands, a_patch_without_a_table_is_recognized_among_designs) {
  scene(json::array());
  const json found = run("discover --topology --scene scene.json --design other.json --design patch.json", 0);
  const json& topology = found["controllers"][0]["topology"];
  EXPECT_EQ(topology["modules"], 12);
  EXPECT_EQ(topology["adjacency"].size(), 12U);
  ASSERT_GE(topology["recognized"].size(), 1U);
  EXPECT_EQ(topology["recognized"][0]["design"], "patch.json");
  EXPECT_TRUE(topology["recognized"][0]["differences"].empty());
  const json stranger = run("discover --topology --scene scene.json --design other.json", 1);
  for (const json& r : stranger["controllers"][0]["topology"]["recognized"]) EXPECT_FALSE(r["differences"].empty());
}

TEST_F(Commands, flash_verify_and_discover_agree_on_sound_hardware) {
  scene(json::array());
  EXPECT_EQ(run("flash patch.json --scene scene.json", 0)["controllers"], 1);
  const json found = run("discover --topology --scene scene.json --design patch.json", 0);
  const json& topology = found["controllers"][0]["topology"];
  EXPECT_TRUE(topology["match"]["differences"].empty());
  std::size_t joints = 0;
  for (const auto& ends : design::joints_of(design_, layout::PatchIndex{0})) {
    for (const auto& e : ends) joints += e.row >= 0 ? 1 : 0;
  }
  EXPECT_EQ(topology["joints"], joints / 2);
  const json verified = run("verify patch.json --scene scene.json --watch-s 0", 0);
  EXPECT_EQ(verified["modules_ok"], 12);
  EXPECT_TRUE(verified["findings"].empty());
}

TEST_F(Commands, a_turned_module_is_named_and_fails_the_command) {
  scene(json::array());
  run("flash patch.json --scene scene.json", 0);
  const int module = design_.patches[0].modules[5].node;
  scene({{{"kind", "rotated_module"}, {"module", module}, {"steps", 1}}});
  const json found = run("discover --topology --scene scene.json --design patch.json", 1);
  EXPECT_EQ(kinds(found["controllers"][0]["topology"]["match"]["differences"]),
            std::vector<std::string>{"rotated_module"});
  const auto findings = kinds(run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 1)["findings"]);
  EXPECT_NE(std::ranges::find(findings, "rotated_module"), findings.end());
}

// A module dies: verify names it; the prepared route for that is flashed and reported, and flashing again restores the
// normal one.
TEST_F(Commands, the_route_prepared_for_a_failure_is_flashed_and_taken_back) {
  scene(json::array());
  run("flash patch.json --scene scene.json", 0);
  const int module = design_.patches[0].modules[7].node;
  const std::string id = std::to_string(module);
  scene({{{"kind", "dead_module"}, {"module", module}}});
  const auto named = run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 1)["findings"];
  EXPECT_TRUE(std::ranges::any_of(named, [&](const json& f) { return f.value("module", -1) == module; })) << named;
  EXPECT_EQ(run("flash patch.json --scene scene.json --route backup:" + id, 0)["route"], "backup:" + id);
  const auto kinds_now = kinds(run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 1)["findings"]);
  EXPECT_NE(std::ranges::find(kinds_now, "backup_route"), kinds_now.end());
  scene(json::array());
  run("flash patch.json --scene scene.json", 0);
  EXPECT_TRUE(run("verify patch.json --scene scene.json --watch-s 0", 0)["findings"].empty());
  for (const char* malformed : {"backup", "backup:99", "backup:x", "sideways"})
    run(std::string("flash patch.json --scene scene.json --route ") + malformed, 2);
}

// The entry dies: the second cable reads the rest, and the commands report that.
TEST_F(Commands, a_dead_entry_is_told_with_the_second_cable) {
  ASSERT_GE(second_entry_row(design_), 1);
  scene(json::array());
  run("flash patch.json --scene scene.json", 0);
  scene({{{"kind", "dead_module"}, {"module", design_.patches[0].entry}}});
  const json found = run("discover --topology --scene scene.json --design patch.json", 1);
  const json& topology = found["controllers"][0]["topology"];
  EXPECT_EQ(topology["route"]["second_cable"], true);
  const auto named = kinds(topology["match"]["differences"]);
  EXPECT_NE(std::ranges::find(named, "second_cable"), named.end());
  EXPECT_NE(std::ranges::find(named, "missing_module"), named.end());
  const json verified = run("verify patch.json --scene scene.json --watch-s 0 --no-touch", 1);
  EXPECT_EQ(verified["modules_ok"], std::popcount(rows_that_survive(design_, {{0}, {}})));
}

TEST_F(Commands, strapped_modules_have_nothing_to_discover) {
  const json found = run("discover --topology --design patch.json", 0);
  EXPECT_FALSE(found["controllers"][0]["topology"]["switched"]);
}

}  // namespace
}  // namespace triskin::test
