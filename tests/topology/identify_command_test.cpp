// SPDX-License-Identifier: GPL-3.0-or-later
// Runs what a person types after plugging in boards that look alike, as processes.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/strip_design.hpp"
#include "support/switched_case.hpp"
#include "triskin/base/files.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;

class AlikeBoards : public SwitchedCase {
 protected:
  design::Design make_design() override { return strip(12, 4); }
  json write(const char* name, json document) const {
    std::ofstream(folder_ / name) << document.dump();
    return document;
  }
  [[nodiscard]] json boards() const { return json::parse(std::ifstream(folder_ / "boards.json")); }
};

TEST_F(AlikeBoards, are_refused_identified_and_flashed) {
  scene(json::array());
  (void)run("flash patch.json --scene scene.json --no-touch", 3);
  const json found = run("identify patch.json --switched -o boards.json", 0);
  ASSERT_EQ(found["boards"].size(), 3U);
  EXPECT_EQ(found["boards"][0]["found_by"], "touch");
  EXPECT_EQ(found["boards"][2]["found_by"], "only");
  EXPECT_TRUE(found["missing"].empty());
  const json simulated = run("simulate scene.json --seconds 0.01", 0, "");
  EXPECT_EQ(simulated["board_seed"], 1);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_EQ(found["boards"][p]["serial"], simulated["boards"][p]["serial"]);
    EXPECT_EQ(boards()["boards"][p]["serial"], simulated["boards"][p]["serial"]);
  }
  const json flashed = run("flash patch.json --scene scene.json --no-touch --assign-file boards.json", 0);
  for (const json& p : flashed["patches"]) EXPECT_EQ(p["found_by"], "name");
  EXPECT_TRUE(run("verify patch.json --scene scene.json --watch-s 0", 0)["findings"].empty());
}

// Boards that share address 1 used not to be asked at all.
TEST_F(AlikeBoards, are_recognised_by_discover_as_one_of_several_patches) {
  scene(json::array());
  const json found = run("discover --topology --scene scene.json --design patch.json", 0);
  ASSERT_EQ(found["controllers"].size(), 3U);
  for (const json& c : found["controllers"]) {
    EXPECT_EQ(c["topology"]["recognized"].size(), 3U);
    EXPECT_EQ(c["topology"]["ambiguous"], true);
  }
}

TEST_F(AlikeBoards, touches_of_the_scene_are_waited_for) {
  const json contact = {{"at_s", 4}, {"until_s", 5}, {"module", 6}, {"radius_mm", 8}};
  write("scene.json", {{"format", "triskin-scene"},
                       {"version", 1},
                       {"design", "patch.json"},
                       {"seed", 9},
                       {"contacts", json::array({contact})}});
  const json found = run("identify patch.json --scene scene.json --patch 1 --limit-s 8 -o boards.json", 0);
  const json simulated = run("simulate scene.json --seconds 0.01", 0, "");
  EXPECT_EQ(found["boards"][0]["serial"], simulated["boards"][1]["serial"]);
  // One board is identified at a time, and the file is extended.
  const json none = run("identify patch.json --scene scene.json --patch 2 --limit-s 2 -o boards.json", 1);
  EXPECT_EQ(none["missing"], json::array({2}));
  EXPECT_EQ(boards()["boards"].size(), 1U);
}

// A board's tables are saved, lost to another design and restored.
TEST_F(AlikeBoards, what_they_hold_is_saved_and_restored) {
  scene(json::array());
  (void)run("flash patch.json --scene scene.json", 0);
  const json flashed = run("flash patch.json --scene scene.json --save kept.json --dry-run", 0);
  EXPECT_EQ(flashed["skipped"], 3);
  const std::string text = read_file(folder_ / "kept.json");
  EXPECT_EQ(run("flash patch.json --scene scene.json --positive-input", 0)["skipped"], 0);
  EXPECT_EQ(run("flash patch.json --scene scene.json --restore kept.json --dry-run", 0)["restored"].size(), 3U);
  EXPECT_EQ(run("flash patch.json --scene scene.json --dry-run", 0)["skipped"], 0);
  const json restored = run("flash patch.json --scene scene.json --restore kept.json", 0);
  EXPECT_EQ(restored["controllers"], 3);
  EXPECT_EQ(restored["bytes"], 3 * (32 + 4 * 12));  // By docs/flash_layout.md there are 32 bytes, and 12 per module.
  EXPECT_EQ(run("flash patch.json --scene scene.json --dry-run", 0)["skipped"], 3);
  EXPECT_TRUE(run("verify patch.json --scene scene.json --watch-s 0", 0)["findings"].empty());
  std::ofstream(folder_ / "cut.json") << text.substr(0, text.size() / 2);
  (void)run("flash patch.json --scene scene.json --restore cut.json", 2);
  (void)run("flash patch.json --scene scene.json --save kept.json --restore kept.json", 2);
  (void)run("flash patch.json --scene scene.json --onto 00112233445566778899AABB=00112233445566778899AABC", 2);
  EXPECT_EQ(read_file(folder_ / "kept.json"), text);
}

TEST_F(AlikeBoards, a_finding_has_the_steps_that_mend_it) {
  scene(json::array());
  (void)run("flash patch.json --scene scene.json", 0);
  scene({{{"kind", "dead_module"}, {"module", 3}}});
  const json findings = run("verify patch.json --scene scene.json --watch-s 0 --report r.txt", 1)["findings"];
  ASSERT_FALSE(findings.empty());
  const json& steps = findings[0]["repair"];
  ASSERT_GE(steps.size(), 5U);
  EXPECT_EQ(steps.front(),
            "keep what the controllers hold: triskin flash patch.json --link sim --scene scene.json "
            "--save before_repair.json --dry-run");
  EXPECT_NE(read_file(folder_ / "r.txt").find("1. keep what the controllers hold"), std::string::npos);
}

TEST_F(AlikeBoards, a_file_that_cannot_be_is_refused) {
  scene(json::array());
  const json good = {{"format", "triskin-boards"},
                     {"version", 1},
                     {"design_id", json::parse(std::ifstream(folder_ / "patch.json"))["design_id"]},
                     {"boards", json::array({{{"patch", 0}, {"serial", "00112233445566778899AABB"}}})}};
  for (const auto& [key, value] : std::map<std::string, json>{{"format", "x"},
                                                              {"version", 2},
                                                              {"design_id", "0000000000000001"},
                                                              {"boards", json::array({{{"patch", 3}, {"serial", ""}}})},
                                                              {"colour", 1}}) {
    json bad = good;
    bad[key] = value;
    write("boards.json", bad);
    (void)run("flash patch.json --scene scene.json --assign-file boards.json", 2);
  }
  write("boards.json", good);
  (void)run("flash patch.json --scene scene.json --assign-file boards.json", 3);  // No such controller answers.
}

}  // namespace
}  // namespace triskin::test
