// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the command on a simulation in real time: the messages that it reports must be those that Fast DDS received, and
// that the RTPS dissector of Wireshark sees on the wire.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "app/cli/shell_case.hpp"
#include "app/library/flashed_sim.hpp"
#include "fast_reader.hpp"
#include "fast_types.hpp"
#include "output/bridge/reader.hpp"
#include "settings.hpp"
#include "skin.h"
#include "support/child_process.hpp"
#include "support/places.hpp"
#include "support/strip_design.hpp"
#include "triskin/bridge/ros_types.hpp"

namespace triskin::foreign {
namespace {

using nlohmann::json;
using test::Child;
using test::ServedSimulation;

std::string bridge_line(const std::string& design, const std::string& link, std::uint32_t domain, int seconds) {
  return "'" + test::program_file() + "' bridge '" + design + "' --link " + link + " --part arm --json --seconds " +
         std::to_string(seconds) + " --domain " + std::to_string(domain);
}

// A finger presses taxel 3 of module 5 with 1 N, from 3 s after the start of the simulation.
std::string pressed_scene(const test::FlashedSim& sim) {
  const std::string scene = sim.folder() / "pressed.json";
  write_file_atomically(scene, R"({"format":"triskin-scene","version":1,"design":"d.json","contacts":[)"
                               R"({"at_s":3,"module":5,"taxel":3,"force_n":1,"radius_mm":3}]})");
  return scene;
}

TEST(BridgeCommand, a_reader_on_Fast_DDS_counts_what_the_command_says) {
  const test::FlashedSim sim;
  const ServedSimulation served(pressed_scene(sim));
  ASSERT_NE(served.link(), "");
  const std::uint32_t id = domain_with();
  Participant participant(id, 0.01);
  FastReader<RawFrame> raw(participant, "rt/skin/arm/raw", "triskin_msgs::msg::dds_::RawFrame_", true, false);
  FastReader<PointCloud2> points(participant, "rt/skin/arm/points", "sensor_msgs::msg::dds_::PointCloud2_", true,
                                 false);
  FastReader<SkinLayout> layout(participant, "rt/skin/arm/layout", "triskin_msgs::msg::dds_::SkinLayout_", true, true);
  FastReader<Contacts> contacts(participant, "rt/skin/arm/contacts", "triskin_msgs::msg::dds_::Contacts_", true, false);
  Child command(bridge_line(sim.design_file(), served.link(), id, 6));
  const json told = json::parse(command.read_all());
  std::set<std::uint64_t> raw_seen;
  std::map<std::uint8_t, std::set<std::uint32_t>> samples;  // The key is the controller.
  raw.take([&](const RawFrame& frame, std::uint64_t sequence) {
    raw_seen.insert(sequence);
    samples[frame.node].insert(frame.sample);
  });
  ASSERT_FALSE(raw_seen.empty());
  // Samples from before the two had found each other are not for this reader; all later ones arrived.
  EXPECT_EQ(*raw_seen.rbegin(), told["published"]["raw"]);
  EXPECT_EQ(raw_seen.size(), *raw_seen.rbegin() - *raw_seen.begin() + 1);
  EXPECT_EQ(told["lost"], 0);
  ASSERT_EQ(samples.size(), 2U);
  for (const auto& [node, numbers] : samples) EXPECT_EQ(numbers.size(), *numbers.rbegin() - *numbers.begin() + 1);
  std::uint64_t clouds = 0;
  EXPECT_GT(points.take([&](const PointCloud2& cloud, std::uint64_t sequence) {
    clouds = sequence;
    EXPECT_EQ(cloud.width, 96U);
  }),
            20U);
  EXPECT_EQ(clouds, told["published"]["points"]);
  EXPECT_EQ(layout.take([&](const SkinLayout& l, std::uint64_t) { EXPECT_EQ(l.design_id, sim.design().design_id); }),
            1U);
  const auto pads =
      design::taxels_of(sim.design().layout.modules[5], design::wiring_of(sim.design())[5].routed.rotation);
  std::uint64_t lists = 0;
  EXPECT_GT(contacts.take([&](const Contacts& c, std::uint64_t sequence) {
    lists = sequence;
    ASSERT_EQ(c.contacts.size(), 1U);
    EXPECT_EQ(c.force_unit, "counts");
    EXPECT_EQ(c.contacts[0].module[0], 5U);
    EXPECT_EQ(c.contacts[0].taxel[0], 3);
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(c.contacts[0].position[axis], pads[3].position_mm[static_cast<int>(axis)] / 1000.0, 0.003);
    EXPECT_EQ(c.contacts[0].normal, (std::array{0.0, 0.0, 1.0}));
  }),
            5U);
  EXPECT_EQ(lists, told["published"]["contacts"]);
}

TEST(BridgeCommand, the_dissector_of_Wireshark_finds_topics_types_qualities_and_every_sample) {
  if (std::system("tshark -v > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "left out: tshark is not installed; run tools/setup test";
  const test::FlashedSim sim;
  const ServedSimulation served(sim.scene_file());
  ASSERT_NE(served.link(), "");
  // Cyclone DDS writes the packets that it sends and receives to a file, so that no rights to capture are needed.
  const std::string packets = sim.folder() / "rtps.pcap";
  const std::uint32_t id = domain_with("<Tracing><PacketCaptureFile>" + packets + "</PacketCaptureFile></Tracing>");
  const dds_entity_t participant = dds_create_participant(id, nullptr, nullptr);  // Without a listener nothing is sent.
  bridge::Reader<triskin_msgs_msg_dds__RawFrame_> raw(participant, triskin_msgs_msg_dds__RawFrame__desc,
                                                      "rt/skin/arm/raw", true, false);
  bridge::Reader<sensor_msgs_msg_dds__PointCloud2_> points(participant, sensor_msgs_msg_dds__PointCloud2__desc,
                                                           "rt/skin/arm/points", true, false);
  bridge::Reader<triskin_msgs_msg_dds__SkinLayout_> layout(participant, triskin_msgs_msg_dds__SkinLayout__desc,
                                                           "rt/skin/arm/layout", true, true);
  Child command(bridge_line(sim.design_file(), served.link(), id, 3));
  const json told = json::parse(command.read_all());
  const auto no_message = [](const auto& /*message*/) {};
  const std::size_t raw_came = raw.take(no_message), points_came = points.take(no_message),
                    layout_came = layout.take(no_message);
  (void)dds_delete(participant);  // closes the file
  const std::string script =
      "python3 '" + test::source_folder() + "/tests/output/foreign_dds/dissect.py' '" + packets + "'";
  const json topics = json::parse(Child(script).read_all());
  // docs/bridge.md gives type, latched, messages that were sent to the reader. Fast DDS does not say how many it keeps.
  using Wanted = std::tuple<const bridge::RosType*, bool, std::size_t>;
  const std::map<std::string, Wanted> wanted{{"rt/skin/arm/raw", {&bridge::kRaw, false, raw_came}},
                                             {"rt/skin/arm/points", {&bridge::kPoints, false, points_came}},
                                             {"rt/skin/arm/layout", {&bridge::kLayout, true, layout_came}},
                                             {"rt/skin/arm/contacts", {&bridge::kContacts, false, 0}},
                                             {"rt/diagnostics", {&bridge::kDiagnostics, false, 0}},
                                             {"rt/tf_static", {&bridge::kTransforms, true, 0}}};
  for (const auto& [name, facts] : wanted) {
    SCOPED_TRACE(name);
    ASSERT_TRUE(topics.contains(name)) << topics;
    const auto& [type, latched, messages] = facts;
    EXPECT_EQ(topics[name]["type"], bridge::dds_name(type->message.name));
    EXPECT_EQ(topics[name]["user_data"], "typehash=" + std::string(type->hash) + ";");
    EXPECT_EQ(topics[name]["reliable"], true);
    EXPECT_EQ(topics[name]["latched"], latched);
    EXPECT_EQ(topics[name]["messages"], messages);
  }
  EXPECT_GT(topics["rt/skin/arm/raw"]["messages"], 20);
  EXPECT_EQ(topics["rt/skin/arm/raw"]["newest"], told["published"]["raw"]);
  EXPECT_EQ(topics["rt/skin/arm/points"]["newest"], told["published"]["points"]);
  EXPECT_EQ(topics["rt/skin/arm/layout"]["messages"], 1);
}

class RobotBridge : public test::ShellCase {};

// Twelve covers on six CAN buses and two USB hubs: Fast DDS receives the samples and the layout of each.
TEST_F(RobotBridge, twelve_covers_by_one_file) {
  constexpr int kCovers = 12, kBuses = 8, kHubs = 2;
  std::string made = "robot new robot.json --name robot";
  for (int b = 0; b < kBuses; ++b) made += fmt::format(" --bus bus{}={}", b, b < kBuses - kHubs ? "sim" : "sim-usb");
  ASSERT_EQ(run(made).status, 0);
  std::vector<design::Design> designs;
  for (int c = 0; c < kCovers; ++c) {
    designs.push_back(test::strip(8 + c, 4));
    design::write_design(folder_ / fmt::format("cover{}.json", c), designs.back());
    const auto added =
        run(fmt::format("robot add robot.json cover{0}.json --name cover{0} --bus bus{1}", c, c % kBuses));
    ASSERT_EQ(added.status, 0) << added.messages;
  }
  ASSERT_EQ(run("flash robot.json").status, 0);
  const std::uint32_t id = domain_with();
  Participant participant(id);
  std::vector<std::unique_ptr<FastReader<RawFrame>>> raw;
  std::vector<std::unique_ptr<FastReader<SkinLayout>>> layout;
  for (int c = 0; c < kCovers; ++c) {
    const std::string topics = fmt::format("rt/skin/cover{}/", c);
    raw.push_back(std::make_unique<FastReader<RawFrame>>(participant, topics + "raw",
                                                         "triskin_msgs::msg::dds_::RawFrame_", true, false));
    layout.push_back(std::make_unique<FastReader<SkinLayout>>(participant, topics + "layout",
                                                              "triskin_msgs::msg::dds_::SkinLayout_", true, true));
  }
  Child simulation("sh -c \"" + line("simulate robot.json --listen 127.0.0.1:0") + " 2>&1\"");
  std::string said = simulation.read_line();
  while (!said.empty() && said.find(" modules on ") == std::string::npos) said = simulation.read_line();
  ASSERT_FALSE(said.empty());
  const auto at = said.find(" modules on ") + 12;
  const std::string link = said.substr(at, said.find(';', at) - at);
  Child command("sh -c \"" + line(fmt::format("bridge robot.json --link {} --json --seconds 6 --domain {}", link, id)) +
                "\"");
  const json told = json::parse(command.read_all());
  ASSERT_EQ(told["covers"].size(), static_cast<std::size_t>(kCovers));
  for (const json& cover : told["covers"]) {
    SCOPED_TRACE(cover.dump());
    const auto c = static_cast<std::size_t>(std::stoi(cover["cover"].get<std::string>().substr(5)));
    EXPECT_EQ(cover["lost"], 0);
    std::set<std::uint64_t> seen;
    std::set<std::uint8_t> nodes;
    raw[c]->take([&](const RawFrame& frame, std::uint64_t sequence) {
      seen.insert(sequence);
      nodes.insert(frame.node);
    });
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(*seen.rbegin(), cover["published"]["raw"]);
    EXPECT_EQ(seen.size(), *seen.rbegin() - *seen.begin() + 1);
    EXPECT_EQ(nodes.size(), designs[c].patches.size());
    EXPECT_EQ(
        layout[c]->take([&](const SkinLayout& l, std::uint64_t) { EXPECT_EQ(l.design_id, designs[c].design_id); }), 1U);
  }
}

}  // namespace
}  // namespace triskin::foreign
