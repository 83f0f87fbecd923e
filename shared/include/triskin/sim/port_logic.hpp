// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// The gates of one switched module (docs/switched_module.md), as the models and the exhaustive test use them.
namespace triskin::sim {

inline constexpr int kNoGrant = 3;

/// What a module sees at its ports and holds inside.
struct PortInputs {
  std::uint8_t enable = 0;  ///< Bit p is the register's output that enables port p.
  std::uint8_t en_in = 0;   ///< Bit p says that the neighbour at port p raises EN.
  int grant = kNoGrant;     ///< The arbiter holds this port as the parent; kNoGrant means none.
};

/// Ports towards which the module raises EN: enabled, not the parent's, and only while it has a parent.
[[nodiscard]] constexpr std::uint8_t en_out(int grant, std::uint8_t enable) {
  if (grant == kNoGrant) return 0;
  return static_cast<std::uint8_t>(enable & 7U & ~(1U << grant));
}

/// Ports whose bus switches are closed: the parent's, and those that it opens while the neighbour does not open them
/// too.
[[nodiscard]] constexpr std::uint8_t switches(const PortInputs& in) {
  if (in.grant == kNoGrant) return 0;
  return static_cast<std::uint8_t>((1U << in.grant) | (en_out(in.grant, in.enable) & ~in.en_in));
}

/// A grant ends when its EN falls; the register is cleared then. A new one is given only when none is held.
[[nodiscard]] constexpr bool loses_grant(const PortInputs& in) {
  return in.grant != kNoGrant && ((in.en_in >> in.grant) & 1U) == 0;
}
/// Ports from which the arbiter may take any one.
[[nodiscard]] constexpr std::uint8_t may_be_granted(const PortInputs& in) {
  return in.grant == kNoGrant ? in.en_in : std::uint8_t{0};
}

}  // namespace triskin::sim
