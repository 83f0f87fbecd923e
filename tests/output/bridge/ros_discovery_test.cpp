// SPDX-License-Identifier: GPL-3.0-or-later
// These tests check the ROS 2 variables that limit node discovery. Source of the expected values: docs.ros.org,
// "Improved Dynamic Discovery" (SUBNET, LOCALHOST, OFF, SYSTEM_DEFAULT; semicolons; ROS_LOCALHOST_ONLY wins).
#include "triskin/bridge/ros_discovery.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "guarantees/faulty_program.hpp"
#include "output/bridge/reader.hpp"
#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/design/design.hpp"

namespace triskin::bridge {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Variables = std::map<std::string, std::string>;

RosDiscovery discovery_of(const Variables& variables) {
  return ros_discovery([&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  });
}
std::string error_of(const Variables& variables) {
  try {
    (void)discovery_of(variables);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(RosDiscovery, nothing_that_is_set_changes_nothing) {
  for (const Variables& v :
       {Variables{}, Variables{{"ROS_LOCALHOST_ONLY", "0"}}, Variables{{"ROS_STATIC_PEERS", ""}},
        Variables{{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}},
        Variables{{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}, {"ROS_STATIC_PEERS", "a"}}}) {
    EXPECT_EQ(discovery_of(v).words, "");
  }
}

TEST(RosDiscovery, localhost_alone_and_its_successor) {
  const RosDiscovery old = discovery_of(
      {{"ROS_LOCALHOST_ONLY", "1"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}, {"ROS_STATIC_PEERS", "192.168.0.1"}});
  EXPECT_EQ(old.range, DiscoveryRange::kLoopback);
  EXPECT_THAT(old.peers, IsEmpty());
  EXPECT_EQ(old.words, "on this computer alone (ROS_LOCALHOST_ONLY=1)");

  const RosDiscovery local = discovery_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}});
  EXPECT_EQ(local.range, DiscoveryRange::kLocalhost);
}

TEST(RosDiscovery, peers_stand_between_semicolons) {
  const RosDiscovery d =
      discovery_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"ROS_STATIC_PEERS", "192.168.0.1; remote.com;;"}});
  EXPECT_THAT(d.peers, ElementsAre("192.168.0.1", "remote.com"));
  EXPECT_THAT(d.words, HasSubstr("192.168.0.1, remote.com (ROS_STATIC_PEERS)"));
  const RosDiscovery subnet = discovery_of({{"ROS_STATIC_PEERS", "fe80::1%eth0"}});
  EXPECT_THAT(subnet.peers, ElementsAre("fe80::1%eth0"));
  EXPECT_THAT(discovery_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "a"}}).peers, IsEmpty());
}

TEST(RosDiscovery, a_wrong_value_is_named_with_its_variable) {
  EXPECT_THAT(error_of({{"ROS_LOCALHOST_ONLY", "yes"}}), HasSubstr("ROS_LOCALHOST_ONLY is yes, not 0 or 1"));
  EXPECT_THAT(error_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"}}),
              HasSubstr("ROS_AUTOMATIC_DISCOVERY_RANGE is localhost, not SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT"));
  EXPECT_THAT(error_of({{"ROS_STATIC_PEERS", "10.0.0.1,10.0.0.2"}}), HasSubstr("semicolons stand between several"));
  EXPECT_THAT(error_of({{"ROS_STATIC_PEERS", "\"/><Peer"}}), HasSubstr("ROS_STATIC_PEERS"));
}

// Two bridges of one part in one domain report that they see each other, unless one of them has discovery off.
// A profile of Fast DDS keeps both on the loopback interface; the variables of ROS 2 come on top of it.
class Discovered : public test::ShellCase {
 protected:
  void SetUp() override {
    test::ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", test::strip(2, 2));
    ASSERT_EQ(run("flash strip.json --link sim").status, 0);
    std::filesystem::copy(folder_ / "state", folder_ / "other", std::filesystem::copy_options::recursive);
    domain_ = test_domain();
    write_file_atomically(folder_ / "loopback.xml",
                          R"(<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
<transport_descriptors><transport_descriptor><transport_id>loopback</transport_id><type>UDPv4</type>
<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList></transport_descriptor></transport_descriptors>
<participant profile_name="loopback" is_default_profile="true"><rtps>
<userTransports><transport_id>loopback</transport_id></userTransports>
<useBuiltinTransports>false</useBuiltinTransports></rtps></participant></profiles>)");
  }
  [[nodiscard]] std::string bridge(const std::string& state, const std::string& variables) const {
    return fmt::format(
        "cd '{}' && exec env -u ROS_LOCALHOST_ONLY FASTRTPS_DEFAULT_PROFILES_FILE=loopback.xml XDG_STATE_HOME={} {} {} "
        "bridge strip.json --link sim --domain {}",
        folder_.string(), state, variables, test::program_file(), domain_);
  }
  std::uint32_t domain_ = 0;
};

constexpr const char* kSeen = "another program publishes";

TEST_F(Discovered, each_configuration_is_taken_by_dds_and_two_bridges_find_each_other) {
  for (const char* variables : {"ROS_LOCALHOST_ONLY=1", "ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST",
                                "ROS_STATIC_PEERS=127.0.0.1", "ROS_LOCALHOST_ONLY=0"}) {
    test::Running one(bridge("state", variables), folder_ / "one"), other(bridge("other", ""), folder_ / "two");
    EXPECT_TRUE(one.says(kSeen)) << variables << "\n" << one.text() << other.text();
    one.signal(SIGINT);
    EXPECT_TRUE(one.ends());
  }
}

TEST_F(Discovered, a_bridge_that_is_off_is_not_found_and_says_so) {
  test::Running off(bridge("state", "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF"), folder_ / "one");
  ASSERT_TRUE(off.says("nobody can find it (ROS_AUTOMATIC_DISCOVERY_RANGE=OFF)")) << off.text();
  test::Running other(bridge("other", "") + " --seconds 4", folder_ / "two");
  EXPECT_TRUE(other.ends());
  EXPECT_THAT(other.text(), Not(HasSubstr(kSeen)));
  EXPECT_THAT(off.text(), Not(HasSubstr(kSeen)));
}

// A network of its own, with the loopback interface and one other that counts what is sent to it. Without the variable
// the bridge looks for others there.
TEST_F(Discovered, with_ROS_LOCALHOST_ONLY_no_packet_leaves_the_loopback_interface) {
  if (std::system("unshare -n ip link show lo > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "left out: this user may not make a network of its own (unshare -n), or iproute2 is not installed";
  const auto sent = [&](const std::string& variables) {
    const std::string script = fmt::format(
        "cd '{0}' && exec unshare -n sh -c '"
        "ip link set lo up && ip link add out0 type veth peer name in0 && ip link set out0 addrgenmode none && ip link "
        "set in0 addrgenmode none up && "
        "ip addr add 10.9.8.7/24 dev out0 && ip link set out0 up && ip route add default dev out0 && "
        "env -u ROS_LOCALHOST_ONLY -u FASTRTPS_DEFAULT_PROFILES_FILE XDG_STATE_HOME=state {1} {2} bridge strip.json "
        "--link sim --seconds 2 --domain {3} > bridge.txt 2>&1 && ip -s -j link show out0 > out0.json'",
        folder_.string(), variables, test::program_file(), domain_);
    EXPECT_EQ(std::system(script.c_str()), 0) << read_file(folder_ / "bridge.txt");
    const std::string counted = read_file(folder_ / "out0.json");
    const std::size_t at = counted.find("\"packets\":", counted.find("\"tx\":"));
    return std::stoi(counted.substr(at + 10));
  };
  EXPECT_EQ(sent("ROS_LOCALHOST_ONLY=1"), 0);
  EXPECT_GT(sent("ROS_LOCALHOST_ONLY=0"), 0);
  EXPECT_EQ(sent("ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"), 0);
  EXPECT_EQ(sent("ROS_AUTOMATIC_DISCOVERY_RANGE=OFF"), 0);
}

TEST_F(Discovered, a_wrong_value_ends_the_command_before_it_publishes) {
  for (const char* variables :
       {"ROS_AUTOMATIC_DISCOVERY_RANGE=ON", "ROS_LOCALHOST_ONLY=true", "ROS_STATIC_PEERS=a,b"}) {
    test::Running wrong(bridge("state", variables), folder_ / "one");
    EXPECT_TRUE(wrong.ends());
    EXPECT_EQ(wrong.status(), 2) << variables;
    EXPECT_THAT(wrong.text(), HasSubstr(std::string(variables).substr(0, std::string(variables).find('='))));
  }
}

}  // namespace
}  // namespace triskin::bridge
