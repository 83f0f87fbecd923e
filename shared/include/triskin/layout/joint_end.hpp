// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

#include "triskin/layout/module.hpp"

namespace triskin::layout {

inline constexpr std::uint8_t kNoModule = 0xFF;

/// One end of a joint: a port of a module. The module is a row of a table, or its number in a discovery. The type of
/// firmware, table and wire; patches that no controller could read need design::PortEnd.
struct JointEnd {
  std::uint8_t module = kNoModule;  ///< It is kNoModule where there is no joint.
  std::uint8_t port = 0;            ///< It ranges from 0 to kPorts − 1.
  /// True when the joint has a far end.
  [[nodiscard]] constexpr bool exists() const { return module != kNoModule; }
  bool operator==(const JointEnd&) const = default;
};

/// An end in one byte, for table and wire: 1 + kPorts · module + port; 0: none.
[[nodiscard]] constexpr std::uint8_t joint_to(std::size_t row, std::size_t port) {
  return static_cast<std::uint8_t>(1 + kPorts * row + port);
}
[[nodiscard]] constexpr std::uint8_t joint_to(JointEnd end) {
  return end.exists() ? joint_to(end.module, end.port) : std::uint8_t{0};
}
/// Far end that a joint byte names; 0: none.
[[nodiscard]] constexpr JointEnd joint_end(std::uint8_t joint) {
  if (joint == 0) return {};
  return {static_cast<std::uint8_t>((joint - 1U) / kPorts), static_cast<std::uint8_t>((joint - 1U) % kPorts)};
}
/// Requires a joint that exists.
[[nodiscard]] constexpr std::size_t joint_row(std::uint8_t joint) {
  return joint_end(joint).module;
}
/// Port 0..2 of a joint byte that is not 0.
[[nodiscard]] constexpr std::uint8_t joint_port(std::uint8_t joint) {
  return joint_end(joint).port;
}

static_assert(joint_to(15, 2) == 48 && joint_end(48) == JointEnd{15, 2});
static_assert(joint_to(JointEnd{}) == 0 && joint_end(0) == JointEnd{} && joint_end(1) == JointEnd{0, 0});

}  // namespace triskin::layout
