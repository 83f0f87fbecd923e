// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// The models and the exhaustive test both use these gates of one switched module (docs/switched_module.md).
namespace triskin::sim {

inline constexpr int kNoGrant = 3;

/// The gates depend on the signals at the ports and on the module's own state.
struct PortInputs {
  std::uint8_t enable = 0;  ///< Bit p is the register output that enables port p.
  std::uint8_t en_in = 0;   ///< Bit p says that the neighbour at port p raises EN.
  int grant = kNoGrant;     ///< The arbiter holds this port as the parent's; kNoGrant means that it holds none.
};

/// Returns the ports at which the module raises EN: those that are enabled and not the parent's, and only while it has
/// a parent.
[[nodiscard]] constexpr std::uint8_t en_out(int grant, std::uint8_t enable) {
  if (grant == kNoGrant) return 0;
  return static_cast<std::uint8_t>(enable & 7U & ~(1U << grant));
}

/// Returns the ports whose bus switches are closed: the parent's, and each enabled port whose neighbour does not enable
/// it as well.
[[nodiscard]] constexpr std::uint8_t switches(const PortInputs& in) {
  if (in.grant == kNoGrant) return 0;
  return static_cast<std::uint8_t>((1U << in.grant) | (en_out(in.grant, in.enable) & ~in.en_in));
}

/// Returns true when EN of the granted port falls, which ends the grant and clears the register. The arbiter gives a
/// new grant only when it holds none.
[[nodiscard]] constexpr bool loses_grant(const PortInputs& in) {
  return in.grant != kNoGrant && ((in.en_in >> in.grant) & 1U) == 0;
}
/// Returns the ports among which the arbiter may choose any.
[[nodiscard]] constexpr std::uint8_t may_be_granted(const PortInputs& in) {
  return in.grant == kNoGrant ? in.en_in : std::uint8_t{0};
}

}  // namespace triskin::sim
