// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

#include "triskin/layout/module.hpp"

namespace triskin::layout {

inline constexpr std::uint8_t kNoModule = 0xFF;

/// An end of a joint is a port of a module. The module is a row of a table, or its number in a discovery. Firmware,
/// table and wire use this type; patches with more modules than a controller can read need design::PortEnd.
struct JointEnd {
  std::uint8_t module = kNoModule;  ///< kNoModule means that no joint exists here.
  std::uint8_t port = 0;            ///< Valid values are 0 to kPorts − 1.
  /// Returns true when the joint has a far end.
  [[nodiscard]] constexpr bool exists() const { return module != kNoModule; }
  bool operator==(const JointEnd&) const = default;
};

/// Packs an end into one byte for table and wire: 1 + kPorts · module + port. The byte 0 means no joint.
[[nodiscard]] constexpr std::uint8_t joint_to(std::size_t row, std::size_t port) {
  return static_cast<std::uint8_t>(1 + kPorts * row + port);
}
[[nodiscard]] constexpr std::uint8_t joint_to(JointEnd end) {
  return end.exists() ? joint_to(end.module, end.port) : std::uint8_t{0};
}
/// Unpacks the far end from a joint byte; the byte 0 gives an end that does not exist.
[[nodiscard]] constexpr JointEnd joint_end(std::uint8_t joint) {
  if (joint == 0) return {};
  return {static_cast<std::uint8_t>((joint - 1U) / kPorts), static_cast<std::uint8_t>((joint - 1U) % kPorts)};
}
/// Returns the row in a joint byte, which must not be 0.
[[nodiscard]] constexpr std::size_t joint_row(std::uint8_t joint) {
  return joint_end(joint).module;
}
/// Returns the port, 0..2, in a joint byte, which must not be 0.
[[nodiscard]] constexpr std::uint8_t joint_port(std::uint8_t joint) {
  return joint_end(joint).port;
}

static_assert(joint_to(15, 2) == 48 && joint_end(48) == JointEnd{15, 2});
static_assert(joint_to(JointEnd{}) == 0 && joint_end(0) == JointEnd{} && joint_end(1) == JointEnd{0, 0});

}  // namespace triskin::layout
