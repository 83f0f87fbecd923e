// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of robots: each contact, fault and expectation belongs to a part, and buses are simulated apart.
#include "triskin/hardware/robot_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene_case.hpp"
#include "triskin/hardware/joint_scene.hpp"

namespace triskin::hardware {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The forearm has six modules and one controller, the torso ten modules and two controllers.
std::vector<RobotPart> parts() {
  return {{"forearm", test::strip(6)}, {"torso", test::strip(10, 5)}};
}

class RobotSceneCase : public SceneCase {
 protected:
  [[nodiscard]] RobotScene read(const std::string& rest) const {
    write_file_atomically(folder_ / "r.json",
                          "{\"format\":\"triskin-scene\",\"version\":1,\n\"robot\":\"bot.json\",\n" + rest + "\n}\n");
    return read_robot_scene(folder_ / "r.json", [this](const std::filesystem::path& robot) {
      EXPECT_EQ(robot, folder_ / "bot.json");
      return parts();
    });
  }
  [[nodiscard]] std::string robot_error_of(const std::string& rest) const {
    try {
      (void)read(rest);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
};

TEST_F(RobotSceneCase, contacts_faults_and_expectations_go_to_their_parts) {
  const RobotScene s = read(R"("seed":9,"contacts":[{"part":"torso","module":7,"radius_mm":8}],
    "faults":[{"part":"forearm","kind":"removed_chip","module":3}],"effects":{"noise_counts":2},
    "expect":[{"at_s":1,"part":"torso","module":7,"pressed":true},{"at_s":1,"part":"forearm","pressed":false},
              {"at_s":2,"pressed":true}])");
  EXPECT_EQ(s.names, (std::vector<std::string>{"forearm", "torso"}));
  ASSERT_EQ(s.parts.size(), 2U);
  EXPECT_TRUE(s.parts[0].contacts.empty());
  ASSERT_EQ(s.parts[1].contacts.size(), 1U);
  // Module 7 of a strip is the fourth tile that points down: corners (120, 0), (135, h) and (105, h), h = 25.98 mm.
  EXPECT_NEAR(s.parts[1].contacts[0].position_mm.x(), 120.0, 1e-9);
  ASSERT_EQ(s.parts[0].faults.size(), 1U);
  EXPECT_TRUE(s.parts[1].faults.empty());
  for (const Scene& part : s.parts) {
    EXPECT_EQ(part.seed, 9U);
    EXPECT_EQ(part.effects.noise_counts, 2.0);
  }
  ASSERT_EQ(s.expectations.size(), 3U);
  EXPECT_EQ(text_of(s.expectations[0]), "at 1 s module 7 of torso is pressed");
  EXPECT_EQ(text_of(s.expectations[1]), "at 1 s the skin of forearm is not pressed");
  EXPECT_EQ(text_of(s.expectations[2]), "at 2 s the skin is pressed");
}

TEST_F(SceneCase, AnExpectationNamesTheNumberOfItsModule) {
  design::Design d = test::strip(6);
  d.layout.numbers = {0, 2, 3, 5, 6, 9};
  d.next_number = 10;
  d.design_id = design::design_id_of(d);
  design::write_design(folder_ / "gaps.json", d);
  write_file_atomically(folder_ / "s.json", R"({"format":"triskin-scene","version":1,"design":"gaps.json","expect":[
    {"at_s":1,"module":9,"pressed":true},{"at_s":1,"module":5,"taxel":3,"pressed":false}]})");
  const Scene s = read_scene(folder_ / "s.json");
  EXPECT_EQ(s.expectations[0].module, 5);
  EXPECT_EQ(text_of(s.expectations[0]), "at 1 s module 9 is pressed");
  EXPECT_EQ(text_of(s.expectations[1]), "at 1 s taxel 3 of module 5 is not pressed");
}

TEST_F(RobotSceneCase, a_bus_gets_what_belongs_to_its_controllers) {
  const RobotScene s = read(R"("contacts":[{"part":"torso","module":7,"until_s":2,"to":{"module":8}}],
    "faults":[{"part":"torso","kind":"stuck_line","patch":0,"line":1},
              {"part":"torso","kind":"stuck_line","patch":1,"line":2},
              {"part":"torso","kind":"swapped_chips","module":7,"other":8},
              {"part":"forearm","kind":"removed_chip","module":3}],
    "effects":{"clock_ppm":{"torso":[10,20]}})");
  const std::vector<RobotPart> all = parts();
  design::Design forearm = all[0].design, torso = all[1].design;
  forearm.node_addresses = {1};
  torso.node_addresses = {0, 2};  // The first controller of the torso is on another bus.
  const std::vector<SimulatedCover> covers{{"forearm", &forearm, {}, &s.parts[0]}, {"torso", &torso, {}, &s.parts[1]}};
  const JointScene joint = join_covers(covers, {1'000'000, 2'000'000});
  EXPECT_EQ(joint.scene.design.patches.size(), 2U);
  ASSERT_EQ(joint.scene.contacts.size(), 1U);
  EXPECT_NEAR(joint.scene.contacts[0].position_mm.x(), 10'120.0, 1e-9);
  EXPECT_NEAR(joint.scene.contacts[0].to_mm.value().x(), 10'135.0, 1e-9);
  const std::vector<Fault>& faults = joint.scene.faults;
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(faults[0].module, 3);
  EXPECT_EQ(faults[1].patch, 1);
  EXPECT_EQ(faults[1].line, 2);
  EXPECT_EQ(faults[2].module, 6 + 7);
  EXPECT_EQ(faults[2].other, 6 + 8);
  EXPECT_EQ(joint.scene.effects.clock_ppm, (std::vector<double>{0.0, 20.0}));
}

TEST_F(RobotSceneCase, a_fault_between_two_buses_is_refused) {
  for (const char* fault : {R"({"part":"torso","kind":"swapped_chips","module":1,"other":7})",
                            R"({"part":"torso","kind":"swapped_chips","module":7,"other":1})"}) {
    const RobotScene s = read(std::string("\"faults\":[") + fault + "]");
    design::Design torso = parts()[1].design;
    torso.node_addresses = {0, 2};
    const std::vector<SimulatedCover> covers{{"torso", &torso, {}, &s.parts[1]}};
    try {
      (void)join_covers(covers, {1'000'000, 2'000'000});
      ADD_FAILURE() << "accepted " << fault;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(),
                  AllOf(HasSubstr("part torso: fault swapped_chips of "), HasSubstr("choose two on one bus")));
    }
  }
}

class BadRobotScenes : public RobotSceneCase, public testing::WithParamInterface<BadScene> {};

TEST_P(BadRobotScenes, are_refused_with_file_path_and_remedy) {
  EXPECT_THAT(robot_error_of(GetParam().line), AllOf(HasSubstr("r.json: /"), HasSubstr(GetParam().remedy)));
}

constexpr BadScene kBad[] = {
    {R"("contacts":[{"module":1}])", "/contacts/0: needs \"part\": forearm, torso"},
    {R"("contacts":[7])", "must be an object"},
    {R"("contacts":[{"part":"leg","module":1}])", "part: \"leg\" is not a part of the robot; it has forearm, torso"},
    {R"("contacts":[{"part":1,"module":1}])", "must be a text"},
    {R"("contacts":[{"part":"forearm","module":7}])", "must be in 0 … 5"},
    {R"("contacts":[{"part":"torso","position_mm":[15,9,500]}])", "the nearest is 500.0 mm away"},
    {R"("contacts":[{"part":"torso","module":1,"until_s":2,"to":{"part":"forearm","module":1}}])", "is unknown"},
    {R"("faults":[{"kind":"removed_chip","module":1}])", "/faults/0: needs \"part\""},
    {R"("faults":[{"part":"forearm","kind":"stuck_line","patch":1,"line":0}])", "patch: must be in 0 … 0"},
    {R"("expect":[{"at_s":1,"module":1,"pressed":true}])", "/expect/0: needs \"part\""},
    {R"("expect":[{"at_s":1,"part":"head","pressed":true}])", "\"head\" is not a part of the robot"},
    {R"("effects":{"bus_bit_rate":1000000})", "stands in the robot file, at each bus"},
    {R"("effects":{"clock_ppm":[1,2]})", "such as {\"torso\": [20, -30]}"},
    {R"("effects":{"clock_ppm":{"leg":[1]}})", "\"leg\" is not a part of the robot"},
    {R"("effects":{"clock_ppm":{"forearm":[1,2]}})", "has 2 clocks, the design has 1 controllers"},
};
INSTANTIATE_TEST_SUITE_P(Robots, BadRobotScenes, testing::ValuesIn(kBad));

TEST_F(RobotSceneCase, a_scene_is_either_of_a_design_or_of_a_robot) {
  EXPECT_THAT(robot_error_of("\"design\":\"d.json\""), HasSubstr("either \"design\" or \"robot\""));
  const std::string head = "{\"format\":\"triskin-scene\",\"version\":1,\n";
  EXPECT_THAT(error_of(head + "\"seed\":1}"), HasSubstr("either \"design\" or \"robot\""));
  EXPECT_THAT(error_of(head + "\"robot\":\"bot.json\"}"), HasSubstr("give its robot file in place of the design"));
  EXPECT_THAT(error_of(head + "\"design\":\"d.json\",\"contacts\":[{\"module\":1,\"part\":\"torso\"}]}"),
              HasSubstr("belongs to the scene of a robot"));
  EXPECT_FALSE(is_robot_scene(folder_ / "s.json"));
  EXPECT_FALSE(is_robot_scene(folder_ / "d.json"));
  (void)read("\"seed\":1");
  EXPECT_TRUE(is_robot_scene(folder_ / "r.json"));
}

}  // namespace
}  // namespace triskin::hardware
