// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/bridge/ros_discovery.hpp"
#include "triskin/bridge/ros_types.hpp"
#include "triskin/core/bytes.hpp"

/// Publishing on DDS (OMG DDS 1.4, DDSI-RTPS 2.5) by Eclipse Cyclone DDS, with the names and settings of ROS 2. The
/// messages come in CDR, as host/recording writes them: no type is described a second time.
namespace triskin::bridge {

/// True: this program was built with Cyclone DDS. Else Domain says so when it is made.
[[nodiscard]] bool dds_available();

/// Delivery that a topic promises its readers. All of it is reliable.
struct Delivery {
  int depth = 10;        ///< So many messages, at least 1, are kept for a slow reader.
  bool latched = false;  ///< A reader that comes late gets the last message too (transient local).
};

/// Writes one topic. Threads: one.
class Publisher {
 public:
  virtual ~Publisher() = default;
  /// Publishes a message in CDR (with the four bytes that name the encoding). Throws DeviceError.
  virtual void write(Bytes message) = 0;
  /// Readers that match now.
  [[nodiscard]] virtual int readers() const = 0;
};

/// Serves requests, as rmw_cyclonedds has them: in front of request and answer stand 16 bytes that say which request it
/// is (triskin/bridge/services.hpp). Threads: one.
class Server {
 public:
  virtual ~Server() = default;
  /// The oldest request that nobody has taken, in CDR; empty: there is none. Throws DeviceError.
  [[nodiscard]] virtual std::optional<std::vector<std::uint8_t>> take() = 0;
  /// Sends an answer in CDR. Throws DeviceError.
  virtual void write(Bytes answer) = 0;
};

/// A participant of a DDS domain. It finds others by itself; CYCLONEDDS_URI may say how.
class Domain {
 public:
  virtual ~Domain() = default;
  /// A writer of the topic `name` as ROS has it ("/skin/arm/raw"); on DDS it is "rt/skin/arm/raw" with the type
  /// "package::msg::dds_::Type_", and USER_DATA carries the type hash. The domain outlives it. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                                             const Delivery& delivery) = 0;
  /// A server of the service `name` as ROS has it ("/skin/arm/tare") of the type "package/srv/Type"; on DDS it reads
  /// "rq/skin/arm/tareRequest" and writes "rr/skin/arm/tareReply". The domain outlives it. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Server> serve(const std::string& name, std::string_view type) = 0;
  /// Writers of the topic `name` in other programs that this one knows of; discovery takes up to a second. Throws
  /// DeviceError. Cost: O(writers of the domain).
  [[nodiscard]] virtual int other_writers(const std::string& name) = 0;
};

/// Joins domain `id` 0 … 232 (ROS_DOMAIN_ID), and looks for others as far as `discovery` says. Throws InputError when
/// this program was built without Cyclone DDS, DeviceError when the network cannot be used.
[[nodiscard]] std::unique_ptr<Domain> join_domain(std::uint32_t id, const RosDiscovery& discovery = {});

}  // namespace triskin::bridge
