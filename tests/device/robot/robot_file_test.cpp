// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "support/strip_design.hpp"
#include "support/temp_folder.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/robot/assembly.hpp"
#include "triskin/robot/edit.hpp"
#include "triskin/robot/robot.hpp"
#include "triskin/robot/site.hpp"

namespace triskin::robot {
namespace {

using testing::HasSubstr;

// Makes two covers on one bus and one on another: 12, 8 and 4 modules on 3, 2 and 1 controllers.
Assembly small_robot() {
  Assembly a;
  a.file = "robot.json";
  a.robot.name = "robot";
  a.robot.buses = {parse_bus("left=can:can0"), parse_bus("right=can:can1@500000")};
  const auto add = [&](const char* name, const char* bus, int modules, int per_patch) {
    a.designs.push_back(test::strip(modules, per_patch));
    CoverEntry cover;
    cover.name = name;
    cover.bus = bus;
    cover.design = std::string(name) + ".json";
    a.robot.covers.push_back(cover);
    seat(a.robot, a.robot.covers.back(), a.designs.back());
  };
  add("upper", "left", 12, 4);
  add("lower", "left", 8, 4);
  add("hand", "right", 4, 4);
  return a;
}

std::string only_problem(const Assembly& a) {
  const auto problems = check(a);
  EXPECT_EQ(problems.size(), 1U);
  return problems.empty() ? "" : problems[0].place + ": " + problems[0].text + "; " + problems[0].remedy;
}

std::vector<int> nodes_of(const CoverEntry& cover) {
  std::vector<int> nodes;
  for (const ControllerEntry& e : cover.controllers) nodes.push_back(e.node);
  return nodes;
}

TEST(RobotFile, is_read_as_it_was_written) {
  Assembly a = small_robot();
  a.robot.urdf = "body.urdf";
  a.robot.buses[0].cable_mm = 1200.5;
  a.robot.covers[0].frame = "l_arm \"1\"";
  a.robot.covers[0].xyz_rpy = {1, 2.5, 3, 0.1, 0.2, 0.3};
  a.robot.covers[0].pose = pose_of(*a.robot.covers[0].xyz_rpy);
  a.robot.covers[1].pose = pose_of({5, 6, 7, 1, 2, 3});
  a.robot.covers[0].has_pose = a.robot.covers[1].has_pose = true;
  a.robot.covers[1].measured = Measured{8, 1.25};
  a.robot.covers[1].rate_hz = 20;
  a.robot.covers[1].controllers[0].serial = "0123456789ABCDEF01234567";
  a.robot.covers[1].controllers[0].bus = "right";
  a.robot.covers[1].controllers[0].cable_mm = 90;
  const std::string text = robot_text(a.robot);
  const Robot back = parse_robot(text, "robot.json");
  EXPECT_EQ(robot_text(back), text);
  EXPECT_EQ(back.covers[0].frame, "l_arm \"1\"");
  EXPECT_EQ(back.covers[1].pose.matrix(), a.robot.covers[1].pose.matrix());  // Every bit must agree.
  EXPECT_TRUE(back.covers[0].pose.isApprox(a.robot.covers[0].pose));
  EXPECT_EQ(back.covers[1].measured->points, 8);
}

TEST(RobotFile, rpy_turns_about_fixed_axes_as_in_urdf) {
  constexpr double kRight = std::numbers::pi / 2;
  // The turn about x comes first: y → z. The one about z follows: z stays, x → y.
  const Eigen::Isometry3d pose = pose_of({0, 0, 0, kRight, 0, kRight});
  EXPECT_TRUE((pose * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE((pose * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(RobotFile, bad_forms_name_file_and_key) {
  Assembly posed = small_robot();
  posed.robot.covers[0].has_pose = true;
  const std::string good = robot_text(posed.robot);
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      (void)parse_robot(text, "r.json");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused("\"version\":1", "\"version\":2"), HasSubstr("this program reads 1"));
  EXPECT_THAT(refused("\"link\":\"can:can0\"", "\"lnik\":\"can:can0\""),
              HasSubstr("/buses/0/lnik: key \"lnik\" is unknown"));
  EXPECT_THAT(refused("\"patch\":0", "\"patch\":-1"), HasSubstr("/covers/0/controllers/0/patch"));
  EXPECT_THAT(refused("\"node\":1", "\"node\":127"), HasSubstr("1 … 126"));
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"up/per\""), HasSubstr("/covers/0/name: must be a name"));
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"左 腕\""), HasSubstr("must be a name"));
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"1arm\""), HasSubstr("must be a name"));
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"arm\u202E\""), HasSubstr("must be a name"));  // turns the text
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"左腕\""), "accepted");
  EXPECT_THAT(refused("\"name\":\"upper\"", "\"name\":\"Überärmel\""), "accepted");
  EXPECT_THAT(refused("[1,0,0,0]", "[-1,0,0,0]"), HasSubstr("mirrors the cover"));
  EXPECT_THAT(refused("[1,0,0,0]", "[2,0,0,0]"), HasSubstr("unit vectors"));
}

TEST(RobotFile, a_place_is_within_reach) {
  require_reach({10'000, -10'000, 0}, "--xyz-mm", "micrometres?");
  for (const double bad_mm : {10'001.0, -1e9, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(require_reach({0, bad_mm, 0}, "--xyz-mm", "micrometres?"), InputError) << bad_mm;
}

TEST(RobotFile, a_design_is_no_robot_wherever_its_format_stands) {
  const auto folder = std::filesystem::temp_directory_path();
  const auto kind_of = [&](const std::string& text) {
    const auto file = folder / fmt::format("kind.{}.json", ::getpid());
    write_file_atomically(file, text);
    const bool is_robot = is_robot_file(file);
    std::filesystem::remove(file);
    return is_robot;
  };
  EXPECT_TRUE(kind_of(R"({"buses":[{"format":"x"}],"format":"triskin-robot"})"));
  EXPECT_FALSE(kind_of(R"({"name":{"format":"triskin-robot"},"format":"triskin-design"})"));
  EXPECT_FALSE(kind_of(R"(["format","triskin-robot"])"));
  EXPECT_FALSE(kind_of("no JSON"));
}

TEST(RobotFile, addresses_of_the_covers_of_a_bus_follow_each_other) {
  const Assembly a = small_robot();
  EXPECT_EQ(nodes_of(a.robot.covers[0]), (std::vector{1, 2, 3}));
  EXPECT_EQ(nodes_of(a.robot.covers[1]), (std::vector{4, 5}));
  EXPECT_EQ(nodes_of(a.robot.covers[2]), (std::vector{1}));
  EXPECT_TRUE(check(a).empty());
}

TEST(RobotFile, a_changed_design_keeps_its_addresses_and_takes_free_ones) {
  Assembly a = small_robot();
  a.robot.covers[0].controllers[1].serial = "0123456789ABCDEF01234567";
  seat(a.robot, a.robot.covers[0], test::strip(16, 4));  // The design has one more patch.
  EXPECT_EQ(nodes_of(a.robot.covers[0]), (std::vector{1, 2, 3, 6}));
  EXPECT_EQ(a.robot.covers[0].controllers[1].serial, "0123456789ABCDEF01234567");
  seat(a.robot, a.robot.covers[0], test::strip(4, 4));
  EXPECT_EQ(nodes_of(a.robot.covers[0]), (std::vector{1}));
  EXPECT_EQ(nodes_of(a.robot.covers[1]), (std::vector{4, 5}));  // Other covers are unchanged.
}

TEST(RobotFile, a_full_range_of_addresses_is_said) {
  Assembly a = small_robot();
  a.robot.buses[1].last_node = 2;
  try {
    seat(a.robot, a.robot.covers[2], test::strip(16, 4));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("bus right has no free node address in 1 … 2"));
  }
}

TEST(RobotCheck, names_thing_place_and_remedy) {
  Assembly a = small_robot();
  a.robot.covers[1].controllers[0].node = layout::NodeAddress{2};
  EXPECT_THAT(only_problem(a),
              HasSubstr("cover lower, patch 0: node address 2 of bus left is also that of cover upper, patch 1"));
  a = small_robot();
  a.robot.buses[0].last_node = 4;
  EXPECT_THAT(only_problem(a), HasSubstr("node address 5 lies outside 1 … 4"));
  a = small_robot();
  a.robot.covers[1].name = "upper";
  EXPECT_THAT(only_problem(a), HasSubstr("cover upper: the name stands there twice"));
  a = small_robot();
  a.robot.covers[0].design_id ^= 1;
  EXPECT_THAT(only_problem(a), HasSubstr("--replace"));
  a = small_robot();
  a.robot.covers[0].controllers.pop_back();
  EXPECT_THAT(only_problem(a), HasSubstr("cover upper, patch 2: has no controller"));
  a = small_robot();
  a.robot.covers[0].controllers[2].patch = layout::PatchIndex{1};
  EXPECT_EQ(check(a).size(), 2U);  // Patch 1 has two, patch 2 has none.
  a = small_robot();
  a.robot.covers[0].controllers[0].bus = "middle";
  EXPECT_THAT(only_problem(a), HasSubstr("there is no bus \"middle\""));
  a = small_robot();
  a.robot.covers[0].controllers[0].serial = a.robot.covers[2].controllers[0].serial = "0123456789ABCDEF01234567";
  EXPECT_THAT(only_problem(a), HasSubstr("is also that of cover upper, patch 0"));
  a = small_robot();
  a.robot.covers[0].frame = "/arm";
  EXPECT_THAT(only_problem(a), HasSubstr("cover upper: its frame \"/arm\" begins with a slash"));
  a = small_robot();
  a.robot.buses[1].link = "can:can2,can:can0";
  EXPECT_THAT(only_problem(a), HasSubstr("bus right: opens can:can0, which bus left opens too"));
}

TEST(RobotCheck, cables_have_their_longest) {
  Assembly a = small_robot();
  a.robot.buses[1].cable_mm = 51'000;  // 25 m at 1 Mbit/s allow 50 m at 500 kbit/s.
  EXPECT_THAT(only_problem(a), HasSubstr("cable of 51.0 m is longer than 50.0 m, the most at 500 kbit/s"));
  a.robot.buses[1].cable_mm = 50'000;
  EXPECT_TRUE(check(a).empty());
  a.robot.covers[0].controllers[0].cable_mm = 800;  // 1.5 m at 1 Mbit/s allow 0.75 m with data at 2 Mbit/s.
  EXPECT_THAT(only_problem(a), HasSubstr("its stub of 0.80 m is longer than 0.75 m"));
  a.robot.covers[0].controllers[0].cable_mm = 700;
  a.robot.buses[0].link = "usb";
  a.robot.covers[0].controllers[0].cable_mm = 5'100;
  EXPECT_THAT(only_problem(a), HasSubstr("5 m"));
}

// By hand: a sample takes 317.5 µs of 1 and 2 Mbit/s, converters run 4 % fast: 20 modules are 1.04 · 20 · 317.5 /
// 36,900 = 17.9 % of the bus. 101 modules are 90.4 % and no longer fit into 90 %.
TEST(RobotCheck, the_samples_of_all_covers_of_a_bus_are_summed) {
  Assembly a = small_robot();
  EXPECT_NEAR(bus_loads(a)[0].full, 0.179, 0.001);
  EXPECT_EQ(bus_loads(a)[0].modules, 20);
  EXPECT_EQ(bus_loads(a)[0].every, 1);
  a.designs[0] = test::strip(93);
  seat(a.robot, a.robot.covers[0], a.designs[0]);
  EXPECT_EQ(bus_loads(a)[0].every, 2);
  EXPECT_TRUE(check(a).empty());
  a.robot.covers[1].rate_hz = 27.0;  // 1e6 / 36,900 = 27.1, but only every second one remains.
  EXPECT_THAT(only_problem(a), HasSubstr("cover lower: wants 27.0 samples a second; bus left carries 13.6"));
}

TEST(Site, has_each_bus_with_its_covers_and_addresses) {
  Assembly a = small_robot();
  a.robot.covers[1].controllers[1].bus = "right";
  a.robot.covers[1].controllers[1].node = layout::NodeAddress{7};
  a.robot.covers[2].rate_hz = 10;
  a.robot.covers[1].rate_hz = 9;
  const Site site = site_of(a);
  ASSERT_EQ(site.buses.size(), 2U);
  ASSERT_EQ(site.buses[0].covers.size(), 2U);
  EXPECT_EQ(site.buses[0].covers[1].design.node_addresses, (std::vector<std::uint8_t>{4, 0}));
  ASSERT_EQ(site.buses[1].covers.size(), 2U);
  EXPECT_EQ(site.buses[1].covers[0].name, "lower");
  EXPECT_EQ(site.buses[1].covers[0].design.node_addresses, (std::vector<std::uint8_t>{0, 7}));
  EXPECT_EQ(site.buses[1].covers[1].first_module, 8);
  EXPECT_EQ(site.buses[0].every, 0);  // The cover upper leaves its rate open.
  EXPECT_EQ(site.buses[1].every, 2);  // 27.1 / 2 = 13.6 is at least 10.
  a.robot.covers[0].controllers[0].node = layout::NodeAddress{2};
  try {
    (void)site_of(a);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("robot.json: 1 problem\n  cover upper, patch 1"));
  }
}

TEST(Frames, of_a_urdf_at_joints_0) {
  const Frames frames = Frames::parse_urdf(R"(<?xml version="1.0"?><robot name="r"><!-- a note -->
    <link name="base"/><link name="arm"><visual/></link><link name="hand"/>
    <joint name="b" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="0 0 0.3"/>
      <axis xyz="0 0.6 0.8"/><limit effort="1" velocity="1" lower="-1" upper="1"/></joint>
    <joint name="a" type="fixed"><parent link="base"/><child link="arm"/>
      <origin xyz="0.1 0 0" rpy="1.5707963267948966 0 0"/></joint></robot>)",
                                           "r.urdf");
  EXPECT_EQ(frames.base(), "base");
  // The hand is 300 mm along the arm's z, which is the base's -y.
  EXPECT_TRUE(frames.pose("hand").translation().isApprox(Eigen::Vector3d(100, -300, 0), 1e-9));
  for (const char* bad : {"<a/>", "<robot><link/></robot>", "no xml", "<robot><link name='a'/><link name='b'/></robot>",
                          "<robot><link name='a'/><joint name='j'><parent link='a'/><child link='c'/></joint></robot>",
                          "<robot><link name='a'/><link name='c'/><joint type='fixed'><parent link='a'/><child "
                          "link='c'/></joint></robot>"})
    EXPECT_THROW((void)Frames::parse_urdf(bad, "r.urdf"), InputError) << bad;
}

// Two links and a joint of which the attributes and what is in it are given.
std::string urdf_with(const std::string& attributes, const std::string& inside) {
  return fmt::format(
      R"(<robot name="r"><link name="a"/><link name="c"/>
           <joint name="j" {}><parent link="a"/><child link="c"/>{}</joint></robot>)",
      attributes, inside);
}

TEST(Frames, turn_by_a_quaternion) {
  // A quarter turn about z takes x to y.
  const Frames frames = Frames::parse_urdf(
      urdf_with("type='fixed'", "<origin xyz='1 0 0' quat_xyzw='0 0 0.70710678118654757 0.70710678118654757'/>"),
      "r.urdf");
  EXPECT_TRUE((frames.pose("c") * Eigen::Vector3d(5, 0, 0)).isApprox(Eigen::Vector3d(1000, 5, 0), 1e-9));
  for (const char* bad : {"quat_xyzw='0 0 1'", "quat_xyzw='0 0 0 0'", "quat_xyzw='0 0 2 0'", "quat_xyzw='0 0 nan 1'",
                          "quat_xyzw='0 0 0 1' rpy='0 0 0'"})
    EXPECT_THROW((void)Frames::parse_urdf(urdf_with("type='fixed'", "<origin " + std::string(bad) + "/>"), "r.urdf"),
                 InputError)
        << bad;
}

TEST(Frames, joints_are_as_ros_demands) {
  const std::string limit = "<limit effort='1' velocity='1' lower='-1' upper='1'/>";
  for (const auto& [type, inside] :
       {std::pair{"revolute", limit}, std::pair{"prismatic", limit + "<axis xyz='0 1 0'/>"},
        std::pair{"continuous", std::string("<axis xyz='0.577 0.577 0.577'/>")}, std::pair{"floating", std::string()}})
    EXPECT_NO_THROW((void)Frames::parse_urdf(urdf_with(fmt::format("type='{}'", type), inside), "r.urdf")) << type;
  for (const auto& [type, inside, what] :
       {std::tuple{"type='revolute'", std::string(), "has no <limit>"},
        std::tuple{"type='revolute'", std::string("<limit lower='0' upper='1'/>"), "has no attribute \"effort\""},
        std::tuple{"type='prismatic'", std::string("<limit effort='1' velocity='1' lower='1' upper='0'/>"),
                   "lower limit above its upper one"},
        std::tuple{"type='hinge'", limit, "has the type \"hinge\"; there are fixed"},
        std::tuple{"", limit, "has no attribute \"type\""},
        std::tuple{"type='continuous'", std::string("<axis xyz='0 0 2'/>"),
                   "axis of length 2; write it with length 1: 0 0 1"},
        std::tuple{"type='continuous'", std::string("<axis xyz='0 0 0'/>"), "axis of length 0"}})
    EXPECT_INPUT_ERROR((void)Frames::parse_urdf(urdf_with(type, inside), "r.urdf"), what);
  EXPECT_INPUT_ERROR((void)Frames::parse_urdf(R"(<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
      <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
      <joint name="j" type="fixed"><parent link="b"/><child link="c"/></joint></robot>)",
                                              "r.urdf"),
                     "joint \"j\" stands there twice");
}

TEST(ParseBus, has_link_and_rates) {
  const BusEntry bus = parse_bus("left=sim:127.0.0.1:7000@500000/4000000");
  EXPECT_EQ(bus.name, "left");
  EXPECT_EQ(bus.link, "sim:127.0.0.1:7000");
  EXPECT_EQ(bus.rates, (wire::BitRates{500'000, 4'000'000}));
  for (const char* bad : {"left", "left=", "=can:can0", "left=can:can0@fast", "left=can:can0@1"})
    EXPECT_THROW((void)parse_bus(bad), InputError) << bad;
}

}  // namespace
}  // namespace triskin::robot
