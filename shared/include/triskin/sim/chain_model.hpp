// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"

namespace triskin::sim {

/// The model is the scan chain of switched modules as its master sees it. The virtual hardware (host/sim/hardware)
/// implements it, and board/posix drives it. The constants are the times that the real chain needs; the caller must let
/// them pass.
class ChainModel {
 public:
  static constexpr std::uint32_t kBit_ns = 500;  ///< The chain is clocked at 2 MHz.
  /// After a latch or a change of EN, ports and arbiters need this time to settle.
  static constexpr std::uint32_t kSettle_ns = 5000;
  virtual ~ChainModel() = default;
  /// Sets EN of the cables: bit 0 to the entry module, bit 1 to the second entry.
  virtual void enable(std::uint8_t cables) = 0;
  /// Shifts bytes through the chain, most significant bit first; `in` receives as many bytes as `out` has.
  virtual void exchange(Bytes out, std::span<std::uint8_t> in) = 0;
  /// Copies the contents of every shift register to its outputs.
  virtual void latch() = 0;
  /// Bit l is set if SDA or SCL of line l is low although nobody drives it.
  [[nodiscard]] virtual std::uint8_t stuck_lines() const = 0;
};

}  // namespace triskin::sim
