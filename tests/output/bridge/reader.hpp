// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "triskin/bridge/dds.hpp"

namespace triskin::bridge {

/// Returns a domain that only this process and its children use. Readers of Cyclone DDS and the command stay on the
/// loopback interface.
inline std::uint32_t test_domain() {
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  ::setenv("CYCLONEDDS_URI",
           "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces><AllowMulticast>false</AllowMulticast>"
           "</General><Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address=\"127.0.0.1\"/></Peers>"
           "</Discovery>",
           1);
  return 20 + static_cast<std::uint32_t>(::getpid()) % 180;
}

/// Joins a domain on the loopback interface.
inline std::unique_ptr<Domain> join_loopback(std::uint32_t id, const RosNode& node = {}) {
  return join_domain(id, {.range = DiscoveryRange::kLoopback, .peers = {}, .words = ""}, node);
}

/// Waits at most half a minute for `done`; returns false if it did not become true.
inline bool wait_until(const std::function<bool()>& done) {
  for (int k = 0; k < 3000; ++k) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Returns the USER_DATA of an endpoint that was found, and frees the endpoint.
inline std::string user_data_of(dds_builtintopic_endpoint_t* endpoint) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string text;
  if (dds_qget_userdata(endpoint->qos, &data, &size)) text.assign(static_cast<const char*>(data), size);
  dds_free(data);
  dds_builtintopic_free_endpoint(endpoint);
  return text;
}

/// Reads a type that idlc described. ROS asks for `reliable` by default, and for best effort for sensor data.
template <class Type>
class Reader {
 public:
  Reader(dds_entity_t participant, const dds_topic_descriptor_t& type, const char* topic, bool reliable, bool latched,
         const std::string& user_data = "") {
    dds_qos_t* qos = dds_create_qos();
    if (!user_data.empty()) dds_qset_userdata(qos, user_data.data(), user_data.size());
    dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
    dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    reader_ =
        dds_create_reader(participant, dds_create_topic(participant, &type, topic, nullptr, nullptr), qos, nullptr);
    dds_delete_qos(qos);
    EXPECT_GT(reader_, 0) << topic;
  }
  /// Calls `handler` for each available message and returns their number.
  std::size_t take(const std::function<void(const Type&)>& handler) {
    std::size_t taken = 0;
    while (true) {
      void* sample = nullptr;
      dds_sample_info_t info;
      if (dds_take(reader_, &sample, &info, 1, 1) <= 0) return taken;
      if (info.valid_data) {
        handler(*static_cast<const Type*>(sample));
        ++taken;
      }
      (void)dds_return_loan(reader_, &sample, 1);
    }
  }
  [[nodiscard]] bool matched() const {
    dds_subscription_matched_status_t status{};
    return dds_get_subscription_matched_status(reader_, &status) == DDS_RETCODE_OK && status.current_count > 0;
  }
  /// Returns the USER_DATA of the writer.
  [[nodiscard]] std::string user_data() const {
    dds_instance_handle_t writer = 0;
    if (dds_get_matched_publications(reader_, &writer, 1) != 1) return "no writer";
    return user_data_of(dds_get_matched_publication_data(reader_, writer));
  }

 private:
  dds_entity_t reader_;
};

}  // namespace triskin::bridge
