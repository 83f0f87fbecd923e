// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/bridge/ros_discovery.hpp"
#include "triskin/bridge/ros_node.hpp"
#include "triskin/bridge/ros_types.hpp"
#include "triskin/core/bytes.hpp"

/// Takes part in DDS (OMG DDS 1.4, DDSI-RTPS 2.5) through eProsima Fast DDS, with the names and settings of ROS 2.
/// Messages are passed as CDR, as host/device/recording writes them, so that no type has to be described twice.
namespace triskin::bridge {

/// Returns true if this program was built with Fast DDS. Otherwise join_domain() throws.
[[nodiscard]] bool dds_available();

/// A topic offers its readers this quality of service; delivery is always reliable.
struct Delivery {
  int depth = 10;        ///< This many messages, at least 1, are kept for a slow reader.
  bool latched = false;  ///< True means that a late reader also gets the last message (transient local).
};

/// Writes one topic. Threads: one.
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Publishes a message in CDR (with the four bytes that name the encoding). Throws DeviceError.
  virtual void write(Bytes message) = 0;
  /// Counts the readers that match now.
  [[nodiscard]] virtual int readers() const = 0;
};

/// Reads one topic with best effort, the newest message only. Threads: one.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  /// Removes and returns the newest message, in CDR; empty if none came since the last call.
  [[nodiscard]] virtual std::optional<std::vector<std::uint8_t>> take() = 0;
};

/// The request that an answer belongs to. The two kinds of clients that ROS 2 has on DDS write it at different places.
struct RequestId {
  std::array<std::uint8_t, 16> client{};  ///< rmw_fastrtps: GUID of who waits; rmw_cyclonedds: its 8 bytes in the body
  std::uint64_t number = 0;               ///< of the client
  std::string cyclone_client;  ///< The client id that a client of rmw_cyclonedds announces; empty: it is of the other.
  bool operator==(const RequestId&) const = default;
};

/// Serves clients of both kinds (triskin/bridge/services.hpp). Threads: one.
class Server {
 public:
  virtual ~Server() = default;
  struct Request {
    RequestId id;
    std::vector<std::uint8_t> message;  ///< in CDR, without what names the request
  };
  /// Removes and returns the oldest request; empty if there is none. Throws DeviceError.
  [[nodiscard]] virtual std::optional<Request> take() = 0;
  /// Sends an answer in CDR as the client expects it, as soon as its reader of answers was discovered; when it was not
  /// within two seconds the answer is dropped. Throws DeviceError.
  virtual void write(const RequestId& id, Bytes answer) = 0;
};

/// A domain object is a participant of a DDS domain and one node of ROS 2. It discovers others by itself;
/// FASTRTPS_DEFAULT_PROFILES_FILE can configure how. The names of topics and services below are those before
/// RosNode::resolve. Thread-safe: each bus of a robot has a thread.
class Domain {
 public:
  virtual ~Domain() = default;
  /// Makes a writer of the topic `name` in the form of ROS ("skin/arm/raw"). On DDS the topic is "rt/skin/arm/raw"
  /// with the type "package::msg::dds_::Type_", and USER_DATA carries the type hash. The domain must outlive it. Throws
  /// DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                                             const Delivery& delivery) = 0;
  /// Makes a reader of the topic `name` of the type "package/msg/Type". The domain must outlive it. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Subscriber> subscribe(const std::string& name, std::string_view type) = 0;
  /// Makes a server of the service `name` in the form of ROS ("skin/arm/tare") and of the type "package/srv/Type". On
  /// DDS it reads "rq/skin/arm/tareRequest" and writes "rr/skin/arm/tareReply", one endpoint each, as clients count
  /// them. The domain must outlive it. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Server> serve(const std::string& name, std::string_view type) = 0;
  /// Counts the known writers of the topic `name` in other programs; discovery takes up to a second. Throws
  /// DeviceError. Cost: O(writers of the domain).
  [[nodiscard]] virtual int other_writers(const std::string& name) = 0;
};

/// Joins domain `id` 0 … 232 (ROS_DOMAIN_ID), looks for other nodes as far as `discovery` allows, and tells them the
/// name of the node. Throws InputError if this program was built without Fast DDS, DeviceError if the network cannot be
/// used.
[[nodiscard]] std::unique_ptr<Domain> join_domain(std::uint32_t id, const RosDiscovery& discovery = {},
                                                  const RosNode& node = {});

}  // namespace triskin::bridge
