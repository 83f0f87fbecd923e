// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "triskin/base/bytes.hpp"

namespace triskin::fw {

/// The scan chain through the switched modules of a patch (docs/switched_module.md). SPI or timer-paced pins on a board.
class RouteChain {
 public:
  virtual ~RouteChain() = default;
  /// EN of the entry module; low closes every port of the patch and clears every register.
  virtual void enable(bool on) = 0;
  /// Shifts `out` in, most significant bit first, and receives as many bytes. At most 19 bytes: 76 µs at 2 MHz.
  virtual void exchange(Bytes out, std::span<std::uint8_t> in) = 0;
  /// Copies every shift register to its outputs; returns when ports and arbiters have settled (5 µs).
  virtual void latch() = 0;
  /// Bit l: SDA or SCL of line l is low while nobody drives it.
  [[nodiscard]] virtual std::uint8_t stuck_lines() = 0;
};

}  // namespace triskin::fw
