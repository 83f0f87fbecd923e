// SPDX-License-Identifier: GPL-3.0-or-later
// Clients with their own types and the decoder of Cyclone DDS use the services of the library and of the command.
#include "triskin/bridge/services.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "app/library/flashed_sim.hpp"
#include "cyclone_client.hpp"
#include "skin.h"
#include "support/child_process.hpp"
#include "support/places.hpp"
#include "triskin/base/files.hpp"

namespace triskin::bridge {
namespace {

using TareClient = Client<triskin_msgs_srv_dds__Tare_Request_, triskin_msgs_srv_dds__Tare_Response_>;
using RerouteClient = Client<triskin_msgs_srv_dds__Reroute_Request_, triskin_msgs_srv_dds__Reroute_Response_>;
using IdentifyClient = Client<triskin_msgs_srv_dds__Identify_Request_, triskin_msgs_srv_dds__Identify_Response_>;

TareClient tare_client(dds_entity_t participant) {
  return {participant, "/skin/arm/tare", triskin_msgs_srv_dds__Tare_Request__desc,
          triskin_msgs_srv_dds__Tare_Response__desc};
}
RerouteClient reroute_client(dds_entity_t participant) {
  return {participant, "/skin/arm/reroute", triskin_msgs_srv_dds__Reroute_Request__desc,
          triskin_msgs_srv_dds__Reroute_Response__desc};
}
IdentifyClient identify_client(dds_entity_t participant) {
  return {participant, "/skin/arm/identify", triskin_msgs_srv_dds__Identify_Request__desc,
          triskin_msgs_srv_dds__Identify_Response__desc};
}

class ServicesTest : public testing::Test {
 protected:
  const std::uint32_t domain_id_ = test_domain();
  const dds_entity_t participant_ = dds_create_participant(domain_id_, nullptr, nullptr);
  ~ServicesTest() override { (void)dds_delete(participant_); }
};

TEST_F(ServicesTest, an_answer_names_the_request_and_both_ends_name_the_service) {
  const auto domain = join_loopback(domain_id_);
  Service<Reroute> service(*domain, "skin/arm");
  const Service<Tare> other(*domain, "skin/arm");
  RerouteClient client = reroute_client(participant_);
  RerouteClient second = reroute_client(participant_);
  ASSERT_TRUE(wait_until([&] { return client.matched() && second.matched(); }));
  EXPECT_EQ(client.server_id().substr(0, 10), "serviceid=");
  EXPECT_EQ(client.server_id(), client.answers().user_data());
  const TareClient tare = tare_client(participant_);
  ASSERT_TRUE(wait_until([&] { return tare.matched(); }));
  EXPECT_NE(tare.server_id(), client.server_id());
  client.send({.client = 0, .number = 0, .patch = 7});
  std::optional<Service<Reroute>::Asked> asked;
  ASSERT_TRUE(wait_until([&] { return (asked = service.take()).has_value(); }));
  EXPECT_EQ(asked->request.patch, 7);
  EXPECT_EQ(asked->id.number, 101U);
  EXPECT_FALSE(service.take().has_value());
  service.answer(asked->id, {.success = true, .message = "m", .patch = {7, 8}, .modules = {-1, 16}});
  EXPECT_TRUE(client.wait([](const auto& a) {
    EXPECT_TRUE(a.success);
    EXPECT_STREQ(a.message, "m");
    ASSERT_EQ(a.patch._length, 2U);
    EXPECT_EQ(a.patch._buffer[1], 8);
    EXPECT_EQ(a.modules._buffer[0], -1);
  }));
  // Every client receives all answers, and recognises its own by the values that the server returned.
  second.send({.client = 0, .number = 0, .patch = -1});
  ASSERT_TRUE(wait_until([&] { return (asked = service.take()).has_value(); }));
  service.answer(asked->id, {});
  EXPECT_TRUE(second.wait([](const auto& a) { EXPECT_FALSE(a.success); }));
  EXPECT_EQ(second.foreign, 1);
}

// Writes data that is no request to the topic of a service, under the name of its type.
class Stranger {
 public:
  explicit Stranger(dds_entity_t participant) {
    // The type has the same name but other members, and lacks the description that would reveal the difference.
    const dds_topic_descriptor_t& any = triskin_msgs_srv_dds__AnyRequest__desc;
    const dds_topic_descriptor_t type{any.m_size,
                                      any.m_align,
                                      any.m_flagset & ~static_cast<std::uint32_t>(DDS_TOPIC_XTYPES_METADATA),
                                      any.m_nkeys,
                                      triskin_msgs_srv_dds__Reroute_Request__desc.m_typename,
                                      any.m_keys,
                                      any.m_nops,
                                      any.m_ops,
                                      any.m_meta,
                                      {},
                                      {},
                                      any.restrict_data_representation};
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    const std::string id = "clientid=0f.1;";
    dds_qset_userdata(qos, id.data(), id.size());
    writer_ = dds_create_writer(participant,
                                dds_create_topic(participant, &type, "rq/skin/arm/rerouteRequest", nullptr, nullptr),
                                qos, nullptr);
    dds_delete_qos(qos);
    EXPECT_GT(writer_, 0);
  }
  [[nodiscard]] bool matched() const {
    dds_publication_matched_status_t status{};
    return dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK && status.current_count > 0;
  }
  void send(std::size_t bytes) const {
    std::vector<std::uint8_t> content(bytes, 1);
    triskin_msgs_srv_dds__AnyRequest_ request{};
    request.bytes._buffer = content.data();
    request.bytes._length = request.bytes._maximum = static_cast<std::uint32_t>(bytes);
    EXPECT_EQ(dds_write(writer_, &request), DDS_RETCODE_OK);
  }

 private:
  dds_entity_t writer_ = 0;
};

// A request has 20 bytes behind the head of its encoding. Shorter ones are malformed, and none can be longer than 64
// KiB.
TEST_F(ServicesTest, malformed_and_oversized_requests_are_dropped_and_the_next_is_served) {
  const auto domain = join_loopback(domain_id_);
  Service<Reroute> service(*domain, "skin/arm");
  const dds_entity_t other = dds_create_participant(domain_id_, nullptr, nullptr);
  const Stranger stranger(other);
  RerouteClient client = reroute_client(participant_);
  ASSERT_TRUE(wait_until([&] { return client.matched() && stranger.matched(); }));
  for (const std::size_t bytes : {std::size_t{100'000}, std::size_t{3}, std::size_t{0}, std::size_t{2'000'000}})
    stranger.send(bytes);
  client.send({.client = 0, .number = 0, .patch = 1});
  std::optional<Service<Reroute>::Asked> asked;
  EXPECT_TRUE(wait_until([&] {
    asked = service.take();
    return asked.has_value();
  }));
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->request.patch, 1);
  (void)dds_delete(other);
}

// Runs the command beside its stream, in another process, on switched modules, one of which is pressed from the third
// second on.
TEST_F(ServicesTest, the_command_tares_reroutes_and_identifies) {
  const test::FlashedSim sim;
  const std::string scene = sim.folder() / "pressed.json";
  write_file_atomically(scene, R"({"format":"triskin-scene","version":1,"design":"d.json","hardware":"switched",)"
                               R"("contacts":[{"at_s":3,"module":5,"taxel":3,"force_n":1,"radius_mm":3}]})");
  const test::ServedSimulation served(scene);
  ASSERT_NE(served.link(), "");
  Reader<triskin_msgs_msg_dds__Contacts_> contacts(participant_, triskin_msgs_msg_dds__Contacts__desc,
                                                   "rt/skin/arm/contacts", true, false);
  TareClient tare = tare_client(participant_);
  RerouteClient reroute = reroute_client(participant_);
  IdentifyClient identify = identify_client(participant_);
  test::Child command("'" + test::program_file() + "' bridge '" + sim.design_file() + "' --link " + served.link() +
                      " --part arm --no-raw --seconds 60 --domain " + std::to_string(domain_id_));
  ASSERT_TRUE(wait_until([&] { return tare.matched() && reroute.matched() && identify.matched(); }));
  identify.send({});
  EXPECT_TRUE(identify.wait([&](const auto& a) {
    EXPECT_TRUE(a.success) << a.message;
    EXPECT_EQ(a.design_id, sim.design().design_id);
    ASSERT_EQ(a.patch._length, 2U);
    ASSERT_EQ(a.serial._length, 2U);
    for (std::uint32_t k = 0; k < 2; ++k) {
      EXPECT_EQ(a.patch._buffer[k], static_cast<int>(k));
      EXPECT_EQ(a.node._buffer[k], k + 1);
      EXPECT_EQ(std::string(a.serial._buffer[k]).size(), 24U);
      EXPECT_EQ(a.table_id._buffer[k], sim.design().design_id);
    }
    EXPECT_STRNE(a.serial._buffer[0], a.serial._buffer[1]);
  }));
  reroute.send({.client = 0, .number = 0, .patch = 1});
  EXPECT_TRUE(reroute.wait([](const auto& a) {
    EXPECT_TRUE(a.success) << a.message;
    ASSERT_EQ(a.patch._length, 1U);
    EXPECT_EQ(a.patch._buffer[0], 1);
    EXPECT_EQ(a.modules._buffer[0], 4);
  }));
  reroute.send({.client = 0, .number = 0, .patch = 9});
  EXPECT_TRUE(reroute.wait([](const auto& a) {
    EXPECT_FALSE(a.success);
    EXPECT_STREQ(a.message, "no controller of patch 9 is on this bus; patches count from 0");
  }));
  std::uint32_t pressed = 0;
  EXPECT_TRUE(wait_until([&] {
    contacts.take([&](const auto& c) { pressed = c.contacts._length; });
    return pressed == 1;
  }));
  tare.send({});
  EXPECT_TRUE(tare.wait([](const auto& a) {
    EXPECT_TRUE(a.success) << a.message;
    EXPECT_EQ(a.taxels, 96U);
  }));
  // A constant press counts as rest from now on.
  EXPECT_TRUE(wait_until([&] {
    contacts.take([&](const auto& c) { pressed = c.contacts._length; });
    return pressed == 0;
  }));
}

TEST(ServiceTypes, definitions_of_the_package_are_those_of_the_program) {
  const auto file = [](const std::string& name) {
    return read_file(std::filesystem::path(test::source_folder()) / "host/output/bridge/ros/triskin_msgs/srv" /
                     (name + ".srv"));
  };
  EXPECT_EQ(file("Tare"), Tare::kDefinition);
  EXPECT_EQ(file("Reroute"), Reroute::kDefinition);
  EXPECT_EQ(file("Identify"), Identify::kDefinition);
  EXPECT_EQ(dds_service_name(Tare::kName), "triskin_msgs::srv::dds_::Tare");
}

}  // namespace
}  // namespace triskin::bridge
