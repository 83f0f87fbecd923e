// SPDX-License-Identifier: GPL-3.0-or-later
// A scene of a robot at the command line: two covers on two buses, one pressed and one with a fault.
#include <gmock/gmock.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "app/cli/shell_case.hpp"
#include "guarantees/faulty_program.hpp"
#include "output/view/browser.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class RobotScenes : public ShellCase {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "six.json", strip(6));
    design::write_design(folder_ / "ten.json", strip(10, 5));
    for (const char* step : {"robot new bot.json --name bot --bus left=sim --bus right=sim",
                             "robot add bot.json six.json --name forearm --bus left",
                             "robot add bot.json ten.json --name torso --bus right"})
      ASSERT_EQ(run(step).status, 0) << step;
  }
  void scene(const std::string& rest, const char* file = "s.json") const {
    write_file_atomically(folder_ / file,
                          "{\"format\":\"triskin-scene\",\"version\":1,\"robot\":\"bot.json\",\n" + rest + "}");
  }
  // A finger of 12 mm presses module 4 of the forearm, and a chip falls off the torso. Times suit a skin whose
  // controllers find their offsets until 0.4 s.
  void two_parts() const {
    scene(R"("contacts":[{"part":"forearm","module":4,"at_s":1,"radius_mm":12,"force_n":6}],
             "faults":[{"part":"torso","kind":"removed_chip","module":7,"at_s":1}],
             "expect":[{"at_s":0.8,"pressed":false},
                       {"at_s":1.5,"part":"forearm","module":4,"more_than_n":1},
                       {"at_s":1.5,"part":"torso","pressed":false},
                       {"at_s":1.5,"until_s":2,"part":"torso","module":7,"state":"absent"},
                       {"at_s":1.5,"part":"torso","module":4,"state":"ok"},
                       {"at_s":1.5,"pressed":true}])");
  }
};

TEST_F(RobotScenes, expectations_hold_on_all_parts) {
  two_parts();
  const Outcome checked = run("simulate s.json --check --json");
  EXPECT_EQ(checked.status, 0) << checked.out << checked.messages;
  const json result = json::parse(checked.out);
  EXPECT_EQ(result["failed"], 0);
  EXPECT_EQ(result["expectations"][1]["expected"], "at 1.5 s module 4 of forearm reports more than 1 N");
  EXPECT_EQ(run("simulate s.json --check --json").out, checked.out);
}

TEST_F(RobotScenes, an_expectation_that_fails_gives_status_1_and_names_the_part) {
  scene(R"("contacts":[{"part":"forearm","module":4,"at_s":1,"radius_mm":12,"force_n":6}],"converters":"ideal",
           "expect":[{"at_s":1.5,"part":"torso","module":4,"pressed":true}])");
  const Outcome checked = run("simulate s.json --check");
  EXPECT_EQ(checked.status, 1);
  EXPECT_THAT(checked.out, HasSubstr("FAILED  /expect/0: at 1.5 s module 4 of torso is pressed (1 sample: 0 counts"));
}

TEST_F(RobotScenes, device_commands_take_the_scene) {
  scene(R"("faults":[{"part":"torso","kind":"removed_chip","module":7}],
           "contacts":[{"part":"forearm","module":4,"at_s":3,"radius_mm":12,"force_n":6}])");
  // The boards' serial numbers ascend with the patches, so that no cable is exchanged.
  const std::string simulated = " --scene s.json --board-seed 0";
  ASSERT_EQ(run("flash bot.json --by-serial" + simulated).status, 0);
  const Outcome verified = run("verify bot.json --json" + simulated);
  EXPECT_EQ(verified.status, 1) << verified.out << verified.messages;
  const json covers = json::parse(verified.out)["covers"];
  ASSERT_EQ(covers.size(), 2U);
  EXPECT_TRUE(covers[0]["findings"].empty()) << covers[0];
  ASSERT_EQ(covers[1]["findings"].size(), 1U) << covers[1];
  EXPECT_EQ(covers[1]["findings"][0]["kind"], "absent_module");
  EXPECT_EQ(covers[1]["findings"][0]["module"], 7);
  const Outcome recorded = run("record bot.json --seconds 4 -o first" + simulated);
  EXPECT_EQ(recorded.status, 1) << recorded.messages;  // A module of the torso is missing.
  EXPECT_THAT(recorded.out, HasSubstr("torso: never heard: module 7"));
  EXPECT_EQ(run("live bot.json --cover forearm --seconds 1 --link sim" + simulated).status, 0);
  EXPECT_EQ(run("verify bot.json --cover forearm" + simulated).status, 0);
  EXPECT_EQ(run("simulate s.json --seconds 1").status, 0);
}

// A finger lies on module 4 of the torso from the start, so both commands see a contact in every run.
TEST_F(RobotScenes, the_page_and_the_bridge_have_the_contacts_of_their_part) {
  scene(R"("contacts":[{"part":"torso","module":4,"at_s":0.5,"radius_mm":12,"force_n":6}])");
  const std::string simulated = " --scene s.json --board-seed 0";
  ASSERT_EQ(run("flash bot.json --by-serial" + simulated).status, 0);
  Running view(line("view bot.json --no-open" + simulated), folder_ / "log");
  ASSERT_TRUE(view.says("/\n")) << view.text();
  LivePage page(page_address(view.text()));
  const json told = json::parse(page.text_with(R"("contacts":[{)"));
  const std::size_t first_of_torso = 6;
  ASSERT_EQ(told["contacts"].size(), 1U) << told;
  EXPECT_EQ(told["contacts"][0]["taxels"][0].get<std::size_t>() / 12, first_of_torso + 4) << told;
  view.signal(SIGINT);
  EXPECT_TRUE(view.ends());
  EXPECT_EQ(view.status(), 0) << view.text();
  const Outcome published = run("bridge bot.json --seconds 2 --domain 47 --json" + simulated);
  if (published.messages.find("built without DDS") != std::string::npos)
    GTEST_SKIP() << "left out: the bridge, since this program was built without DDS";
  ASSERT_EQ(published.status, 0) << published.messages;
  const json covers = json::parse(published.out)["covers"];
  EXPECT_EQ(covers[0]["published"]["contacts"], 0);
  EXPECT_GE(covers[1]["published"]["contacts"].get<int>(), 10);
}

TEST_F(RobotScenes, a_scene_of_another_robot_or_of_a_design_is_refused) {
  two_parts();
  ASSERT_EQ(run("robot new other.json --name other --bus left=sim").status, 0);
  ASSERT_EQ(run("robot add other.json six.json --name hand --bus left").status, 0);
  const Outcome other = run("record other.json --scene s.json --seconds 1 -o x");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.messages, AllOf(HasSubstr("s.json: its robot"), HasSubstr("has no cover hand")));
  ASSERT_EQ(run("robot new third.json --name third --bus left=sim").status, 0);
  ASSERT_EQ(run("robot add third.json ten.json --name forearm --bus left").status, 0);
  EXPECT_THAT(run("record third.json --scene s.json --seconds 1 -o x").messages, HasSubstr("cover forearm has design"));
  write_file_atomically(folder_ / "d.json", R"({"format":"triskin-scene","version":1,"design":"six.json"})");
  const Outcome design = run("record bot.json --scene d.json --seconds 1 -o x");
  EXPECT_EQ(design.status, 2);
  EXPECT_THAT(design.messages, AllOf(HasSubstr("d.json: /design: "), HasSubstr("is a scene of one design")));
  const Outcome robot = run("record six.json --link sim --scene s.json --seconds 1 -o x.mcap");
  EXPECT_EQ(robot.status, 2);
  EXPECT_THAT(robot.messages, HasSubstr("give its robot file in place of the design"));
  EXPECT_THAT(run("touched s.json -o r.json").messages, HasSubstr("s.json: is a scene of a robot, but regions are"));
  EXPECT_EQ(run("record bot.json --link sim:127.0.0.1:1 --scene s.json --seconds 1 -o x").status, 2);
}

}  // namespace
}  // namespace triskin::test
