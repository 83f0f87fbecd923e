// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <string>

#include "triskin/layout/module.hpp"

namespace triskin::design {

/// The address strap of a module as every output names it: the two solder bridges that a person closes, which lie at
/// the pins ADD0 and ADD1 (L: to ground, H: to the supply), and the I²C address that the AD7147 then has, as
/// "ADD0L ADD1H (2E)". `address`: 0 … 3. Constant cost.
[[nodiscard]] inline std::string address_strap(int address) {
  return fmt::format("ADD0{} ADD1{} ({:02X})", (address & 1) != 0 ? 'H' : 'L', (address & 2) != 0 ? 'H' : 'L',
                     layout::cdc_address(address));
}

}  // namespace triskin::design
