// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"

namespace triskin::fw {

/// The scan chain runs through the switched modules of a patch (docs/switched_module.md). A board drives it with SPI or
/// timer-paced pins.
class RouteChain {
 public:
  virtual ~RouteChain() = default;
  /// Sets EN of the cables, a bit each: 1 to the entry module, 2 to the second entry. With both low, every port of the
  /// patch is closed and every register cleared. The returned data are the OR of both cables.
  virtual void enable(std::uint8_t cables) = 0;
  /// Shifts `out` in, most significant bit first, and receives as many bytes. At most 19 bytes are allowed, which take
  /// 76 µs at 2 MHz.
  virtual void exchange(Bytes out, std::span<std::uint8_t> in) = 0;
  /// Copies every shift register to its outputs; returns when ports and arbiters have settled (5 µs).
  virtual void latch() = 0;
  /// Bit l is set if SDA or SCL of line l is low although nobody drives it.
  [[nodiscard]] virtual std::uint8_t stuck_lines() = 0;
};

}  // namespace triskin::fw
