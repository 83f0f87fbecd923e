// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

/// These numbers describe a module and the controller that reads it. No other file repeats them; the side length of a
/// module belongs to the geometry.
namespace triskin::layout {

inline constexpr int kTaxelsPerModule = 12;  ///< Each taxel is one of the inputs CIN0 … CIN11 of the module's AD7147.
/// In every mask of taxels, bit t stands for taxel t.
inline constexpr std::uint16_t kAllTaxels = (1U << kTaxelsPerModule) - 1U;
/// These two taxels measure temperature and do not react to a finger. The others measure pressure.
inline constexpr std::array<std::size_t, 2> kTemperaturePads{6, 10};

/// Returns true if a taxel measures pressure. `taxel`: 0 … kTaxelsPerModule − 1.
[[nodiscard]] constexpr bool measures_pressure(std::size_t taxel) {
  for (const std::size_t pad : kTemperaturePads) {
    if (pad == taxel) return false;
  }
  return true;
}
/// Bit t is set if taxel t measures pressure.
inline constexpr std::uint16_t kPressureTaxels = [] {
  unsigned mask = kAllTaxels;
  for (const std::size_t pad : kTemperaturePads) mask &= ~(1U << pad);
  return static_cast<std::uint16_t>(mask);
}();
inline constexpr int kPressureTaxelsPerModule = kTaxelsPerModule - static_cast<int>(kTemperaturePads.size());

inline constexpr std::size_t kPorts = 3;       ///< A module has one port on each side: A, B and C.
inline constexpr std::uint8_t kRotations = 3;  ///< Port A may lie on any of the three sides of the tile.
inline constexpr int kLines = 4;               ///< A controller has four I²C lines.
inline constexpr int kAddressesPerLine = 4;    ///< The AD7147 has two address pins, hence four addresses.
inline constexpr int kMaxModules = kLines * kAddressesPerLine;
/// The AD7147 has this address when ADD1 = ADD0 = 0 (data sheet).
inline constexpr std::uint8_t kFirstCdcAddress = 0x2C;

/// Returns the 7-bit address of a converter on its line. `address`: 0 … kAddressesPerLine − 1, as in the table.
[[nodiscard]] constexpr std::uint8_t cdc_address(int address) {
  return static_cast<std::uint8_t>(kFirstCdcAddress + address);
}

/// A controller that was never assigned a node address has kFirstNode.
inline constexpr std::uint8_t kFirstNode = 1, kLastNode = 126;
inline constexpr std::size_t kMaxNodes = kLastNode - kFirstNode + 1;
/// Returns true for 1 … 126, the addresses that a controller may have.
[[nodiscard]] constexpr bool is_node_address(unsigned address) {
  return address >= kFirstNode && address <= kLastNode;
}

static_assert(kPressureTaxels == 0b1011'1011'1111);
static_assert(measures_pressure(5) && !measures_pressure(6) && !measures_pressure(10) && measures_pressure(11));
static_assert(!is_node_address(0) && is_node_address(1) && is_node_address(126) && !is_node_address(127));

}  // namespace triskin::layout
