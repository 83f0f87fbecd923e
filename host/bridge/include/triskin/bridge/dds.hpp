// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "triskin/base/bytes.hpp"
#include "triskin/bridge/ros_types.hpp"

/// Publishing on DDS (OMG DDS 1.4, DDSI-RTPS 2.5) by Eclipse Cyclone DDS, with the names and settings of ROS 2. The
/// messages come in CDR, as host/recording writes them: no type is described a second time.
namespace triskin::bridge {

/// True: this program was built with Cyclone DDS. Else Domain says so when it is made.
[[nodiscard]] bool dds_available();

/// What a topic promises its readers. All of it is reliable.
struct Delivery {
  int depth = 10;        ///< messages that are kept for a reader that is slow, ≥ 1
  bool latched = false;  ///< who comes late gets the last message too (transient local)
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

/// A participant of a DDS domain. It finds others by itself; CYCLONEDDS_URI may say how.
class Domain {
 public:
  virtual ~Domain() = default;
  /// A writer of the topic `name` as ROS has it ("/skin/arm/raw"); on DDS it is "rt/skin/arm/raw" with the type
  /// "package::msg::dds_::Type_", and USER_DATA carries the type hash. The domain outlives it. Throws DeviceError.
  [[nodiscard]] virtual std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                                             const Delivery& delivery) = 0;
};

/// Joins domain `id` 0 … 232 (ROS_DOMAIN_ID). Throws InputError when this program was built without Cyclone DDS,
/// DeviceError when the network cannot be used.
[[nodiscard]] std::unique_ptr<Domain> join_domain(std::uint32_t id);

}  // namespace triskin::bridge
