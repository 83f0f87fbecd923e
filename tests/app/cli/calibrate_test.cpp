// SPDX-License-Identifier: GPL-3.0-or-later
// Follows a calibration from the command line to the numbers of live, record and replay.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "shell_case.hpp"
#include "support/strip_design.hpp"
#include "triskin/design/design_text.hpp"

namespace triskin {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Calibrated : public test::ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", test::strip(4));
    write_scene("");
    ASSERT_EQ(run("flash strip.json --link sim --scene scene.json").status, 0);
  }
  // The bounds of the test are those of this noise alone.
  void write_scene(const std::string& more) const {
    std::ofstream(folder_ / "scene.json") << R"({"format":"triskin-scene","version":1,"design":"strip.json","seed":5,)"
                                             R"("converters":"ideal")" +
                                                 more + R"(,"effects":{"sensitivity_spread":0.3,"noise_counts":2}})";
  }
  [[nodiscard]] json last_of(const std::string& arguments) const {
    const auto outcome = run(arguments + " --json");
    EXPECT_EQ(outcome.status, 0) << arguments << outcome.messages;
    return json::parse(outcome.out.substr(outcome.out.rfind('\n', outcome.out.size() - 2) + 1));
  }
};

// 30 kPa on 4 modules of 389.7 mm² are 46.77 N.
TEST_F(Calibrated, counts_become_newton) {
  const std::string bag = R"(,"pressure":[{"at_s":0.5,"kpa":0},{"at_s":0.6,"kpa":30}])";
  write_scene(bag);
  const std::string live = "live strip.json --link sim --scene scene.json --seconds 3";
  const json before = last_of(live);
  EXPECT_EQ(before["unit"], "counts");
  EXPECT_FALSE(before.contains("force_n"));
  EXPECT_TRUE(before["calibration"].is_null());

  write_scene("");
  const json made = last_of("calibrate strip.json --link sim --scene scene.json --steps 5,10,20,30,40 -o cal.json");
  EXPECT_EQ(made["taxels"], 40);
  EXPECT_LE(made["worst_percent"], 1.0);
  ASSERT_EQ(made["boards"].size(), 1U);
  EXPECT_EQ(made["boards"][0]["revision"], 1);

  write_scene(bag);
  const json after = last_of(live);
  EXPECT_EQ(after["unit"], "kPa");
  EXPECT_NEAR(after["force_n"].get<double>(), 46.77, 0.01 * 46.77);  // The command needs sensitivities and noise.
  ASSERT_EQ(after["pressed"].size(), 40U);
  constexpr double kFourDeviations_kpa = 4.0 * 0.32;  // Of the noise of a sample and of the rest value.
  for (const json& t : after["pressed"]) EXPECT_NEAR(t["pressure_kpa"].get<double>(), 30.0, kFourDeviations_kpa);
  EXPECT_EQ(after["calibration"]["boards"][0]["revision"], 1);
  EXPECT_EQ(last_of(live + " --calibration none")["unit"], "counts");

  ASSERT_EQ(last_of("record strip.json --link sim --scene scene.json --seconds 2 -o r.mcap")["lost"], 0);
  const json replayed = last_of("replay r.mcap --speed 0");
  EXPECT_EQ(replayed["unit"], "kPa");
  EXPECT_NEAR(replayed["force_n"].get<double>(), 46.77,
              0.01 * 46.77);  // The command uses the rest values that the calibration holds.

  ASSERT_EQ(run("calibrate strip.json --link sim --scene scene.json --forget").status, 0);
  EXPECT_EQ(last_of(live)["unit"], "counts");
  EXPECT_EQ(last_of(live + " --calibration cal.json")["unit"], "kPa");
}

TEST_F(Calibrated, a_backup_carries_it_and_a_restore_keeps_it_again) {
  ASSERT_EQ(run("calibrate strip.json --link sim --scene scene.json --weights 200,500,1000,2000").status, 0);
  ASSERT_EQ(run("flash strip.json --link sim --scene scene.json --save kept.json --dry-run").status, 0);
  ASSERT_EQ(run("calibrate strip.json --link sim --scene scene.json --forget").status, 0);
  const auto restored = run("flash strip.json --link sim --scene scene.json --restore kept.json");
  EXPECT_EQ(restored.status, 0) << restored.messages;
  EXPECT_THAT(restored.out, HasSubstr("revision 1 of its calibration is kept again"));
  EXPECT_EQ(last_of("live strip.json --link sim --scene scene.json --seconds 1")["unit"], "kPa");
}

TEST_F(Calibrated, a_module_is_calibrated_alone_and_the_others_keep_theirs) {
  const std::string how = "calibrate strip.json --link sim --scene scene.json ",
                    live = "live strip.json --link sim --seconds 1";
  const json alone = last_of(how + "--weights 200,500,1000,2000 --modules 2");
  EXPECT_EQ(alone["taxels"], 10);
  EXPECT_EQ(last_of(live)["unit"], "counts") << "three modules have none";
  ASSERT_EQ(run(how + "--steps 5,10,20,30,40").status, 0);
  const json again = last_of(how + "--weights 200,500,1000,2000 --modules 1-2");
  EXPECT_EQ(again["taxels"], 20);
  EXPECT_EQ(again["boards"][0]["revision"], 3);
  EXPECT_EQ(again["left"], "");
  EXPECT_EQ(last_of(live)["unit"], "kPa") << "modules 0 and 3 keep what they had";
  const auto refused = run(how + "--weights 200,500,1000 --modules 3,4");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.messages, HasSubstr("there is no module 4; the design has 0-3"));
}

// The bag presses with 30 kPa and the calibration ends at 20.
TEST_F(Calibrated, what_lies_above_the_calibrated_range_is_marked) {
  ASSERT_EQ(run("calibrate strip.json --link sim --scene scene.json --steps 5,10,20").status, 0);
  for (const int kpa : {15, 30}) {
    write_scene(R"(,"pressure":[{"at_s":0.5,"kpa":0},{"at_s":0.6,"kpa":)" + std::to_string(kpa) + "}]");
    const json live = last_of("live strip.json --link sim --scene scene.json --seconds 2");
    ASSERT_EQ(live["pressed"].size(), 40U);
    for (const json& taxel : live["pressed"]) EXPECT_EQ(taxel.contains("above_calibration"), kpa == 30);
    ASSERT_FALSE(live["contacts"].empty());
    for (const json& contact : live["contacts"]) EXPECT_EQ(contact.contains("above_calibration"), kpa == 30);
    const std::string text = run("live strip.json --link sim --scene scene.json --seconds 2").out;
    EXPECT_EQ(text.find("above the calibrated range") != std::string::npos, kpa == 30) << text;
  }
}

TEST_F(Calibrated, what_presses_has_to_be_said_once) {
  EXPECT_EQ(run("calibrate strip.json --link sim").status, 2);
  EXPECT_EQ(run("calibrate strip.json --link sim --steps 5,10 --weights 100,200").status, 2);
  EXPECT_EQ(run("calibrate strip.json --link sim --steps 5").status, 2);
}

}  // namespace
}  // namespace triskin
