// SPDX-License-Identifier: GPL-3.0-or-later
// Clients as rmw_fastrtps and as rmw_cyclonedds write them call one service at once, beside others that send rubbish.
#include "fast_client.hpp"

#include <gtest/gtest.h>

#include "app/library/flashed_sim.hpp"
#include "output/bridge/cyclone_client.hpp"
#include "skin.h"
#include "support/child_process.hpp"
#include "support/places.hpp"
#include "triskin/bridge/parameters.hpp"
#include "triskin/bridge/services.hpp"

namespace triskin::foreign {
namespace {

using Rerouted = bridge::Client<triskin_msgs_srv_dds__Reroute_Request_, triskin_msgs_srv_dds__Reroute_Response_>;
using Tared = bridge::Client<triskin_msgs_srv_dds__Tare_Request_, triskin_msgs_srv_dds__Tare_Response_>;
constexpr const char* kReroute = "triskin_msgs::srv::dds_::Reroute";
constexpr const char* kTare = "triskin_msgs::srv::dds_::Tare";

// By hand: the encoding (CDR, little-endian), then int32 patch.
Message reroute_request(std::int32_t patch) {
  Message m{0, 1, 0, 0};
  for (int k = 0; k < 4; ++k) m.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(patch) >> (8 * k)));
  return m;
}
// A message without fields has one byte.
const Message kTareRequest{0, 1, 0, 0, 0};

class BothKinds : public testing::Test {
 protected:
  const std::uint32_t domain_id_ = domain_with();
  const dds_entity_t cyclone_ = dds_create_participant(domain_id_, nullptr, nullptr);
  ~BothKinds() override { (void)dds_delete(cyclone_); }
};

TEST_F(BothKinds, each_client_of_one_name_gets_the_answer_to_its_own_request) {
  const auto domain = join_loopback(domain_id_);
  bridge::Service<bridge::Reroute> service(*domain, "skin/arm");
  Participant participant(domain_id_);
  FastClient fast(participant, "/skin/arm/reroute", kReroute), second(participant, "/skin/arm/other", kReroute);
  Rerouted slow(cyclone_, "/skin/arm/reroute", triskin_msgs_srv_dds__Reroute_Request__desc,
                triskin_msgs_srv_dds__Reroute_Response__desc);
  ASSERT_TRUE(wait_until([&] { return fast.is_ready() && slow.matched(); }));
  EXPECT_EQ(participant.readers_of("rq/skin/arm/rerouteRequest"), 1);
  EXPECT_EQ(participant.writers_of("rr/skin/arm/rerouteReply"), 1);
  EXPECT_FALSE(second.is_ready());
  const auto serve = [&] {
    while (const auto asked = service.take())
      service.answer(
          asked->id,
          {.success = true, .message = "m", .patch = {asked->request.patch}, .modules = {2 * asked->request.patch}});
  };
  for (int round = 1; round <= 20; ++round) {
    fast.send(reroute_request(round));
    slow.send({.client = 0, .number = 0, .patch = 100 + round});
    EXPECT_TRUE(fast.wait(
        [&](Cdr& cdr) {
          bool success = false;
          std::string message;
          std::vector<std::int32_t> patch, modules;
          cdr >> success >> message >> patch >> modules;
          EXPECT_TRUE(success);
          EXPECT_EQ(message, "m");
          EXPECT_EQ(patch, (std::vector<std::int32_t>{round}));
          EXPECT_EQ(modules, (std::vector<std::int32_t>{2 * round}));
        },
        serve));
    EXPECT_TRUE(slow.wait(
        [&](const auto& a) {
          ASSERT_EQ(a.patch._length, 1U);
          EXPECT_EQ(a.patch._buffer[0], 100 + round);
          EXPECT_EQ(a.modules._buffer[0], 200 + 2 * round);
        },
        serve));
  }
}

// Lengths that promise more than there is, and messages of the other kind's form, in each position that a length has.
TEST_F(BothKinds, hostile_lengths_are_dropped_and_both_kinds_are_served_after_them) {
  const auto domain = join_loopback(domain_id_);
  bridge::Service<bridge::Reroute> service(*domain, "skin/arm");
  bridge::ParameterServices parameters(*domain, {{"points_hz", 5.0, ""}});
  Participant participant(domain_id_), hostile_participant(domain_id_);
  FastClient fast(participant, "/skin/arm/reroute", kReroute),
      hostile(hostile_participant, "/skin/arm/reroute", kReroute);
  FastClient names(hostile_participant, "/triskin_bridge/get_parameters", "rcl_interfaces::srv::dds_::GetParameters");
  FastClient values(hostile_participant, "/triskin_bridge/set_parameters", "rcl_interfaces::srv::dds_::SetParameters");
  Rerouted slow(cyclone_, "/skin/arm/reroute", triskin_msgs_srv_dds__Reroute_Request__desc,
                triskin_msgs_srv_dds__Reroute_Response__desc);
  ASSERT_TRUE(wait_until([&] {
    return fast.is_ready() && hostile.is_ready() && slow.matched() && names.is_ready() && values.is_ready();
  }));
  int served = 0;
  const auto serve = [&] {
    parameters.step();
    while (const auto asked = service.take()) {
      EXPECT_TRUE(asked->request.patch == 1 || asked->request.patch == 2);
      service.answer(asked->id, {.success = true, .message = "", .patch = {}, .modules = {}});
      ++served;
    }
  };
  // Empty, too short, of other encodings, and longer than the server keeps. RTPS fills messages up to four bytes.
  for (const Message& m : {Message{}, Message{0, 1, 0, 0}, Message{0, 0, 0, 0, 0, 0, 0, 9},
                           Message{0, 7, 0, 0, 9, 0, 0, 0}, Message(200'000, 1)})
    hostile.send(m);
  // One name of 4 GB; 4 billion names; a text that ends behind the message; and a value with 2^31 texts in it.
  for (const Message& m :
       {Message{0, 1, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff}, Message{0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff},
        Message{0, 1, 0, 0, 1, 0, 0, 0, 9, 0, 0, 0, 'a', 0}})
    names.send(m);
  Message value{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 9, 0};
  value.resize(value.size() + 40, 0);
  value.insert(value.end(), {0xff, 0xff, 0xff, 0x7f});
  values.send(value);
  fast.send(reroute_request(1));
  slow.send({.client = 0, .number = 0, .patch = 2});
  EXPECT_TRUE(fast.wait([](Cdr&) {}, serve));
  EXPECT_TRUE(slow.wait([](const auto&) {}, serve));
  EXPECT_EQ(served, 2);
  names.send({0, 1, 0, 0, 1, 0, 0, 0, 10, 0, 0, 0, 'p', 'o', 'i', 'n', 't', 's', '_', 'h', 'z', 0});
  EXPECT_TRUE(names.wait(
      [](Cdr& cdr) {
        std::uint32_t n = 0;
        std::uint8_t type = 0;
        bool truth = true;
        std::int64_t whole = 1;
        double number = 0.0;
        cdr >> n >> type >> truth >> whole >> number;
        EXPECT_EQ(n, 1U);
        EXPECT_EQ(type, 3);
        EXPECT_EQ(number, 5.0);
      },
      serve));
}

// The command beside its stream, in another process, called by both kinds at once.
TEST_F(BothKinds, the_command_tares_and_reroutes_for_both) {
  const test::FlashedSim sim;
  const std::string scene = sim.folder() / "switched.json";
  write_file_atomically(
      scene, R"({"format":"triskin-scene","version":1,"design":"d.json","hardware":"switched","contacts":[]})");
  const test::ServedSimulation served(scene);
  ASSERT_NE(served.link(), "");
  Participant participant(domain_id_);
  FastClient reroute(participant, "/skin/arm/reroute", kReroute), tare(participant, "/skin/arm/tare", kTare);
  Rerouted slow_reroute(cyclone_, "/skin/arm/reroute", triskin_msgs_srv_dds__Reroute_Request__desc,
                        triskin_msgs_srv_dds__Reroute_Response__desc);
  Tared slow_tare(cyclone_, "/skin/arm/tare", triskin_msgs_srv_dds__Tare_Request__desc,
                  triskin_msgs_srv_dds__Tare_Response__desc);
  test::Child command("'" + test::program_file() + "' bridge '" + sim.design_file() + "' --link " + served.link() +
                      " --part arm --no-raw --seconds 60 --domain " + std::to_string(domain_id_));
  ASSERT_TRUE(wait_until(
      [&] { return reroute.is_ready() && tare.is_ready() && slow_reroute.matched() && slow_tare.matched(); }));
  tare.send(kTareRequest);
  slow_tare.send({});
  EXPECT_TRUE(tare.wait([](Cdr& cdr) {
    bool success = false;
    std::string message;
    std::uint32_t taxels = 0;
    cdr >> success >> message >> taxels;
    EXPECT_TRUE(success) << message;
    EXPECT_EQ(taxels, 96U);
  }));
  EXPECT_TRUE(slow_tare.wait([](const auto& a) {
    EXPECT_TRUE(a.success) << a.message;
    EXPECT_EQ(a.taxels, 96U);
  }));
  reroute.send(reroute_request(1));
  slow_reroute.send({.client = 0, .number = 0, .patch = 0});
  EXPECT_TRUE(reroute.wait([](Cdr& cdr) {
    bool success = false;
    std::string message;
    std::vector<std::int32_t> patch, modules;
    cdr >> success >> message >> patch >> modules;
    EXPECT_TRUE(success) << message;
    EXPECT_EQ(patch, (std::vector<std::int32_t>{1}));
    EXPECT_EQ(modules, (std::vector<std::int32_t>{4}));
  }));
  EXPECT_TRUE(slow_reroute.wait([](const auto& a) {
    EXPECT_TRUE(a.success) << a.message;
    ASSERT_EQ(a.patch._length, 1U);
    EXPECT_EQ(a.patch._buffer[0], 0);
  }));
}

}  // namespace
}  // namespace triskin::foreign
