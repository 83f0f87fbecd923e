// SPDX-License-Identifier: GPL-3.0-or-later
// What ROS 2 shows of the bridge as a node: its name, its parameters, arguments behind --ros-args, and the messages for
// viewers and controllers. Readers with their own types and the decoder of Cyclone DDS look at it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "cyclone_client.hpp"
#include "guarantees/faulty_program.hpp"
#include "skin.h"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/bridge/bridge.hpp"
#include "triskin/bridge/parameters.hpp"
#include "triskin/bridge/services.hpp"

namespace triskin::bridge {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kStart_ns = 1'700'000'000'250'000'000;

RosNode node_of(const std::vector<std::string>& arguments, std::string_view distribution = "") {
  return ros_node(arguments, distribution);
}
std::string error_of(const std::vector<std::string>& arguments) {
  try {
    (void)node_of(arguments);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

// Source: design.ros2.org, "Topic and Service name mapping" and "Static Remapping".
TEST(RosNode, names_are_expanded_and_remapped_as_ROS_does) {
  EXPECT_EQ(node_of({}).resolve("skin/arm/raw"), "/skin/arm/raw");
  EXPECT_EQ(node_of({}).resolve("/tf_static"), "/tf_static");
  EXPECT_EQ(node_of({}).resolve("~/get_parameters"), "/triskin_bridge/get_parameters");
  const RosNode left =
      node_of({"-r", "__ns:=/robot/left", "--remap", "__node:=skin_node", "-r", "skin/arm/raw:=arm/raw", "-r",
               "/diagnostics:=diagnostics", "-r", "other:skin/arm/layout:=never", "-r",
               "skin_node:skin/arm/points:=/points", "--log-level", "debug"});
  EXPECT_EQ(left.resolve("skin/arm/contacts"), "/robot/left/skin/arm/contacts");
  EXPECT_EQ(left.resolve("skin/arm/raw"), "/robot/left/arm/raw");
  EXPECT_EQ(left.resolve("/diagnostics"), "/robot/left/diagnostics");
  EXPECT_EQ(left.resolve("skin/arm/layout"), "/robot/left/skin/arm/layout");
  EXPECT_EQ(left.resolve("skin/arm/points"), "/points");
  EXPECT_EQ(left.resolve("~/list_parameters"), "/robot/left/skin_node/list_parameters");
}

TEST(RosNode, parameters_have_the_types_of_YAML) {
  const auto p =
      node_of({"-p", "use_sim_time:=true", "-p", "n:points_hz:=20", "-p", "rate:=2.5", "-p", "parent:='1'"}).parameters;
  EXPECT_EQ(std::get<bool>(p.at("use_sim_time")), true);
  EXPECT_EQ(std::get<std::int64_t>(p.at("points_hz")), 20);
  EXPECT_EQ(std::get<double>(p.at("rate")), 2.5);
  EXPECT_EQ(std::get<std::string>(p.at("parent")), "1");
}

TEST(RosNode, a_wrong_argument_is_named) {
  EXPECT_THAT(error_of({"-r"}), HasSubstr("--ros-args -r: its value is missing"));
  EXPECT_THAT(error_of({"-r", "__ns:=robot"}), HasSubstr("a namespace begins with /"));
  EXPECT_THAT(error_of({"-r", "__node:=a b"}), HasSubstr("letters, digits and _"));
  EXPECT_THAT(error_of({"-r", "raw"}), HasSubstr("a rule is NAME:=VALUE"));
  EXPECT_THAT(error_of({"-r", "a b:=c"}), HasSubstr("names of topics or services"));
  EXPECT_THAT(error_of({"--params-file", "x.yaml"}), HasSubstr("no files of parameters"));
}

TEST(RosNode, the_distribution_says_how_long_identifiers_are) {
  EXPECT_TRUE(node_of({}, "humble").gid_has_24_bytes);
  EXPECT_FALSE(node_of({}, "jazzy").gid_has_24_bytes);
  EXPECT_FALSE(node_of({}).gid_has_24_bytes);
}

class NodeTest : public testing::Test {
 protected:
  const std::uint32_t domain_id_ = test_domain();
  const design::Design design_ = test::strip(8, 4);
  const dds_entity_t participant_ = dds_create_participant(domain_id_, nullptr, nullptr);
  ~NodeTest() override { (void)dds_delete(participant_); }
  [[nodiscard]] BridgeOptions options() const {
    BridgeOptions o;
    o.part = "arm";
    o.raw = false;
    o.points_hz = 0.0;
    return o;
  }
};

using Entities = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;

// GUIDs of the endpoints of others on topics of ROS, as Cyclone discovered them, once there are `count`.
std::vector<std::array<std::uint8_t, 16>> endpoints_of(dds_entity_t participant, dds_entity_t builtin,
                                                       std::size_t count) {
  std::vector<std::array<std::uint8_t, 16>> guids;
  const dds_entity_t reader = dds_create_reader(participant, builtin, nullptr, nullptr);
  EXPECT_TRUE(wait_until([&] {
    void* sample = nullptr;
    dds_sample_info_t info;
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      const auto* e = static_cast<const dds_builtintopic_endpoint_t*>(sample);
      const std::string topic = info.valid_data ? e->topic_name : "";
      if (topic.starts_with("rt/") || topic.starts_with("rq/") || topic.starts_with("rr/"))
        std::copy_n(e->key.v, 16, guids.emplace_back().begin());
      (void)dds_return_loan(reader, &sample, 1);
    }
    return guids.size() >= count;
  }));
  (void)dds_delete(reader);
  std::ranges::sort(guids);
  return guids;
}

template <class Gids>
std::vector<std::array<std::uint8_t, 16>> sorted(const Gids& gids) {
  std::vector<std::array<std::uint8_t, 16>> guids;
  for (std::uint32_t k = 0; k < gids._length; ++k) std::copy_n(gids._buffer[k].data, 16, guids.emplace_back().begin());
  std::ranges::sort(guids);
  return guids;
}

TEST_F(NodeTest, a_foreign_reader_of_ros_discovery_info_finds_the_name_and_exactly_the_endpoints_that_are_there) {
  const auto domain = join_loopback(domain_id_, node_of({"-r", "__ns:=/left", "-r", "__node:=skin_node"}));
  const Bridge bridge(*domain, design_, options(), kStart_ns);
  const Service<Tare> tare(*domain, "skin/arm");
  Reader<Entities> reader(participant_, rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc, "ros_discovery_info",
                          true, true);
  // contacts, markers, layout, diagnostics, tf_static and the answers; the requests.
  const auto written = endpoints_of(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, 6);
  const auto read = endpoints_of(participant_, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, 1);
  EXPECT_EQ(written.size(), 6U);
  EXPECT_EQ(read.size(), 1U);
  EXPECT_TRUE(wait_until([&] {
    return reader.take([&](const Entities& e) {
      ASSERT_EQ(e.node_entities_info_seq._length, 1U);
      const auto& node = e.node_entities_info_seq._buffer[0];
      EXPECT_STREQ(node.node_namespace, "/left");
      EXPECT_STREQ(node.node_name, "skin_node");
      EXPECT_EQ(sorted(node.writer_gid_seq), written);
      EXPECT_EQ(sorted(node.reader_gid_seq), read);
      EXPECT_TRUE(std::equal(e.gid.data, e.gid.data + 12, written.at(0).begin()));
    }) > 0;
  }));
}

TEST_F(NodeTest, nodes_of_Humble_get_identifiers_of_24_bytes) {
  const auto domain = join_loopback(domain_id_, node_of({}, "humble"));
  const Bridge bridge(*domain, design_, options(), kStart_ns);
  // The type has the name of the short one, and lacks the description that would reveal the difference.
  const dds_topic_descriptor_t& own = rmw_dds_common_msg_dds__LongParticipant__desc;
  const dds_topic_descriptor_t type{own.m_size,
                                    own.m_align,
                                    own.m_flagset & ~static_cast<std::uint32_t>(DDS_TOPIC_XTYPES_METADATA),
                                    own.m_nkeys,
                                    rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc.m_typename,
                                    own.m_keys,
                                    own.m_nops,
                                    own.m_ops,
                                    own.m_meta,
                                    {},
                                    {},
                                    own.restrict_data_representation};
  Reader<rmw_dds_common_msg_dds__LongParticipant_> reader(participant_, type, "ros_discovery_info", true, true);
  EXPECT_TRUE(wait_until([&] {
    return reader.take([&](const auto& e) {
      ASSERT_EQ(e.node_entities_info_seq._length, 1U);
      EXPECT_STREQ(e.node_entities_info_seq._buffer[0].node_name, "triskin_bridge");
      const auto& gids = e.node_entities_info_seq._buffer[0].writer_gid_seq;
      ASSERT_EQ(gids._length, 5U);
      for (std::uint32_t k = 0; k < 5; ++k) {
        EXPECT_TRUE(std::equal(gids._buffer[k].data, gids._buffer[k].data + 12, e.gid.data));
        EXPECT_TRUE(std::all_of(gids._buffer[k].data + 16, gids._buffer[k].data + 24, [](auto b) { return b == 0; }));
      }
    }) > 0;
  }));
}

using ListClient =
    Client<rcl_interfaces_srv_dds__ListParameters_Request_, rcl_interfaces_srv_dds__ListParameters_Response_>;
using GetClient =
    Client<rcl_interfaces_srv_dds__GetParameters_Request_, rcl_interfaces_srv_dds__GetParameters_Response_>;
using SetClient =
    Client<rcl_interfaces_srv_dds__SetParameters_Request_, rcl_interfaces_srv_dds__SetParameters_Response_>;

TEST_F(NodeTest, parameters_are_listed_read_and_not_set) {
  const auto domain = join_loopback(domain_id_, node_of({"-r", "__node:=n"}));
  ParameterServices services(
      *domain, {{"use_sim_time", false, "a"}, {"points_hz", 12.5, "b"}, {"parent", std::string("hand"), "c"}});
  ListClient list(participant_, "/n/list_parameters", rcl_interfaces_srv_dds__ListParameters_Request__desc,
                  rcl_interfaces_srv_dds__ListParameters_Response__desc);
  GetClient get(participant_, "/n/get_parameters", rcl_interfaces_srv_dds__GetParameters_Request__desc,
                rcl_interfaces_srv_dds__GetParameters_Response__desc);
  SetClient set(participant_, "/n/set_parameters", rcl_interfaces_srv_dds__SetParameters_Request__desc,
                rcl_interfaces_srv_dds__SetParameters_Response__desc);
  ASSERT_TRUE(wait_until([&] { return list.matched() && get.matched() && set.matched(); }));
  const auto step = [&] { services.step(); };
  list.send({});
  EXPECT_TRUE(list.wait(
      [](const auto& a) {
        ASSERT_EQ(a.names._length, 3U);
        EXPECT_STREQ(a.names._buffer[1], "points_hz");
      },
      step));
  std::array<char*, 3> names{const_cast<char*>("points_hz"), const_cast<char*>("none"), const_cast<char*>("parent")};
  rcl_interfaces_srv_dds__GetParameters_Request_ asked{};
  asked.names._length = asked.names._maximum = 3;
  asked.names._buffer = names.data();
  get.send(asked);
  EXPECT_TRUE(get.wait(
      [](const auto& a) {
        ASSERT_EQ(a.values._length, 3U);
        EXPECT_EQ(a.values._buffer[0].type, 3);
        EXPECT_EQ(a.values._buffer[0].double_value, 12.5);
        EXPECT_EQ(a.values._buffer[1].type, 0);
        EXPECT_EQ(a.values._buffer[2].type, 4);
        EXPECT_STREQ(a.values._buffer[2].string_value, "hand");
      },
      step));
  rcl_interfaces_msg_dds__Parameter_ given{};
  given.name = names[0];
  given.value.type = 3;
  given.value.string_value = const_cast<char*>("");
  rcl_interfaces_srv_dds__SetParameters_Request_ wish{};
  wish.parameters._length = wish.parameters._maximum = 1;
  wish.parameters._buffer = &given;
  set.send(wish);
  EXPECT_TRUE(set.wait(
      [](const auto& a) {
        ASSERT_EQ(a.results._length, 1U);
        EXPECT_FALSE(a.results._buffer[0].successful);
        EXPECT_THAT(a.results._buffer[0].reason, HasSubstr("-p points_hz:=VALUE"));
      },
      step));
}

recording::Contact contact_at(const design::Vec3& position_mm, const design::Vec3& normal, double force_n) {
  recording::Contact c;
  c.position_mm = position_mm;
  c.normal = normal;
  c.force_n = force_n;
  c.change_counts = 5000.0;
  c.taxels = {{layout::ModuleId{5}, layout::TaxelIndex{3}, 5000.0, position_mm, normal, force_n}};
  return c;
}

// By hand: 3 N push at (0.1, 0, 0) m along -z. The link sees the cover turned by 90 degrees about z and shifted by
// 1 m along x, so they push at (1, 0.1, 0) along -z: torque = (1, 0.1, 0) x (0, 0, -3) = (-0.3, 3, 0) Nm.
TEST_F(NodeTest, the_wrench_is_that_of_the_contacts_in_the_frame_of_the_link) {
  const auto domain = join_loopback(domain_id_);
  BridgeOptions o = options();
  o.calibration.by_taxel = true;
  o.parent_frame = "hand";
  o.frame_prefix = "left/";
  o.pose = {{1.0, 0.0, 0.0}, {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)}};
  Bridge bridge(*domain, design_, o, kStart_ns);
  EXPECT_EQ(bridge.frame(), "left/skin_arm");
  Reader<geometry_msgs_msg_dds__WrenchStamped_> reader(participant_, geometry_msgs_msg_dds__WrenchStamped__desc,
                                                       "rt/skin/arm/wrench", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  EXPECT_EQ(reader.user_data(), "typehash=" + std::string(kWrench.hash) + ";");
  const std::vector<recording::Contact> contacts{contact_at({100.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 3.0)};
  bridge.add_contacts(contacts, kStart_ns);
  bridge.add_contacts({}, kStart_ns + 1);
  std::size_t came = 0;
  EXPECT_TRUE(wait_until([&] {
    reader.take([&](const auto& w) {
      EXPECT_STREQ(w.header.frame_id, "left/hand");
      const double newton = came++ == 0 ? 3.0 : 0.0;
      EXPECT_NEAR(w.wrench.force.z, -newton, 1e-12);  // rounding of the quaternion
      EXPECT_NEAR(w.wrench.torque.x, -0.1 * newton, 1e-12);
      EXPECT_NEAR(w.wrench.torque.y, newton, 1e-12);
      EXPECT_NEAR(w.wrench.torque.z, 0.0, 1e-12);
    });
    return came == 2;
  }));
}

TEST_F(NodeTest, markers_are_a_triangle_a_module_and_an_arrow_a_contact_and_times_are_those_of_the_clock) {
  const auto domain = join_loopback(domain_id_);
  Bridge bridge(*domain, design_, options(), kStart_ns);
  bridge.set_clock_offset(-static_cast<std::int64_t>(kStart_ns) + 5'000'000'007);
  Reader<visualization_msgs_msg_dds__MarkerArray_> reader(participant_, visualization_msgs_msg_dds__MarkerArray__desc,
                                                          "rt/skin/arm/markers", true, false);
  ASSERT_TRUE(wait_until([&] { return reader.matched() && bridge.readers() == 1; }));
  const std::vector<recording::Contact> contacts{contact_at({100.0, 20.0, 0.0}, {0.0, 0.0, 1.0}, 0.0)};
  bridge.add_contacts(contacts, kStart_ns);
  bridge.add_contacts({}, kStart_ns + 1);
  std::size_t came = 0;
  EXPECT_TRUE(wait_until([&] {
    reader.take([&](const auto& a) {
      ASSERT_EQ(a.markers._length, 2U);
      const auto& modules = a.markers._buffer[0];
      const auto& arrow = a.markers._buffer[1];
      EXPECT_STREQ(modules.header.frame_id, "skin_arm");
      EXPECT_EQ(modules.header.stamp.sec, 5);
      EXPECT_EQ(modules.header.stamp.nanosec, 7U + came);
      EXPECT_EQ(modules.type, 11);
      ASSERT_EQ(modules.points._length, 24U);
      ASSERT_EQ(modules.colors._length, 24U);
      EXPECT_DOUBLE_EQ(modules.points._buffer[3 * 5].x, design_.layout.modules[5].corner_mm[0].x() / 1000.0);
      EXPECT_STREQ(arrow.ns, "contacts");
      if (came++ == 0) {
        EXPECT_NE(modules.colors._buffer[3 * 5].r, modules.colors._buffer[3 * 4].r);
        EXPECT_EQ(arrow.type, 0);
        EXPECT_EQ(arrow.action, 0);
        ASSERT_EQ(arrow.points._length, 2U);  // from 15 mm above the skin (5000 counts) onto it
        EXPECT_NEAR(arrow.points._buffer[0].z, 0.015, 1e-12);
        EXPECT_DOUBLE_EQ(arrow.points._buffer[1].x, 0.1);
      } else {
        EXPECT_EQ(modules.colors._buffer[3 * 5].r, modules.colors._buffer[3 * 4].r);
        EXPECT_EQ(arrow.action, 2);
      }
    });
    return came == 2;
  }));
}

TEST_F(NodeTest, a_clock_of_ROS_is_read) {
  const auto domain = join_loopback(domain_id_);
  const auto clock = domain->subscribe("/clock", "rosgraph_msgs/msg/Clock");
  const dds_entity_t writer = dds_create_writer(
      participant_, dds_create_topic(participant_, &rosgraph_msgs_msg_dds__Clock__desc, "rt/clock", nullptr, nullptr),
      nullptr, nullptr);
  ASSERT_GT(writer, 0);
  const rosgraph_msgs_msg_dds__Clock_ now{{12, 34}};
  std::optional<std::vector<std::uint8_t>> message;
  EXPECT_TRUE(wait_until([&] {
    EXPECT_EQ(dds_write(writer, &now), DDS_RETCODE_OK);
    return (message = clock->take()).has_value();
  }));
  recording::CdrReader r(message.value());
  EXPECT_EQ(r.u32(), 12U);
  EXPECT_EQ(r.u32(), 34U);
}

class BridgeArguments : public test::ShellCase {};

// The command under --ros-args: a namespace, a stop by counts on a topic of its own, and a parameter that is wrong.
TEST_F(BridgeArguments, the_command_takes_ros_arguments_and_refuses_wrong_ones_by_name) {
  design::write_design(folder_ / "strip.json", test::strip(2, 2));
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  const std::string domain = " --domain " + std::to_string(test_domain());
  const auto told = run("bridge strip.json --link sim --seconds 1 --part arm --stop-counts 500" + domain +
                        " --ros-args -r __ns:=/left -p points_hz:=5 -p raw:=false");
  EXPECT_EQ(told.status, 0) << told.messages;
  EXPECT_THAT(told.out, HasSubstr("publishing /left/skin/"));
  EXPECT_THAT(told.out, HasSubstr("stop: "));
  EXPECT_THAT(told.out, HasSubstr("0 raw messages"));
  const auto wrong = run("bridge strip.json --link sim --seconds 1" + domain + " --ros-args -p points:=5");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.messages, HasSubstr("-p points: there is no such parameter"));
  const auto unit = run("bridge strip.json --link sim --seconds 1" + domain + " --ros-args -p points_hz:=often");
  EXPECT_EQ(unit.status, 2);
  EXPECT_THAT(unit.messages, HasSubstr("must be a number"));
}

// The boards are calibrated by the program; then 2 N press taxel 3 of module 5 with a contact of 8 mm on the layer. The
// force of such a contact scatters by 1.6 % (docs/calibration.md), to which comes 1.7 % of the calibration; 10 % is
// four times both.
TEST_F(BridgeArguments, the_wrench_of_a_known_contact_is_within_its_stated_error) {
  const design::Design design = test::strip(8, 4);
  design::write_design(folder_ / "strip.json", design);
  write_file_atomically(
      folder_ / "press.json",
      R"({"format":"triskin-scene","version":1,"design":"strip.json","effects":{"layer":{"thickness_mm":2,)"
      R"("poisson":0.3,"electrode_mm":4}},"contacts":[{"at_s":1,"module":5,"taxel":3,"force_n":2,"radius_mm":8}]})");
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  ASSERT_EQ(run("calibrate strip.json --link sim --steps 5,10,20").status, 0);
  const std::uint32_t domain = test_domain();
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  Reader<geometry_msgs_msg_dds__WrenchStamped_> reader(participant, geometry_msgs_msg_dds__WrenchStamped__desc,
                                                       "rt/skin/arm/wrench", true, false);
  const auto told =
      run("bridge strip.json --link sim --scene press.json --part arm --no-raw --points-hz 0 --parent hand "
          "--seconds 4 --domain " +
          std::to_string(domain));
  EXPECT_EQ(told.status, 0) << told.messages;
  std::array<double, 5> last{};  // force x, y, z, torque x, y
  EXPECT_GT(reader.take([&](const auto& w) {
    EXPECT_STREQ(w.header.frame_id, "hand");
    last = {w.wrench.force.x, w.wrench.force.y, w.wrench.force.z, w.wrench.torque.x, w.wrench.torque.y};
  }),
            5U);
  const auto taxels = design::taxels_of(design.layout.modules[5], design::wiring_of(design)[5].routed.rotation);
  const design::Vec3 at_m = taxels[3].position_mm / 1000.0;
  EXPECT_NEAR(last[2], -2.0, 0.2);
  EXPECT_NEAR(last[3], -2.0 * at_m.y(), 0.2 * at_m.y());
  EXPECT_NEAR(last[4], 2.0 * at_m.x(), 0.2 * at_m.x());
  EXPECT_EQ(last[0], 0.0);  // the strip is flat, and no shear is felt
  EXPECT_EQ(last[1], 0.0);
  (void)dds_delete(participant);
}

}  // namespace
}  // namespace triskin::bridge
