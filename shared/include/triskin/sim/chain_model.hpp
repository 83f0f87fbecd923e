// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"

namespace triskin::sim {

/// The scan chain of switched modules as its master sees it. Implemented by the virtual hardware (host/sim), driven
/// by board/posix. Times are what the real chain needs: the caller lets them pass.
class ChainModel {
 public:
  static constexpr std::uint32_t kBit_ns = 500;  ///< The chain is clocked with 2 MHz.
  /// Ports and arbiters need this time after a latch or a change of EN.
  static constexpr std::uint32_t kSettle_ns = 5000;
  virtual ~ChainModel() = default;
  /// EN of the cables: bit 0 to the entry module, bit 1 to the second entry.
  virtual void enable(std::uint8_t cables) = 0;
  /// Bytes most significant bit first; `in` gets as many.
  virtual void exchange(Bytes out, std::span<std::uint8_t> in) = 0;
  /// Copies every shift register to its outputs.
  virtual void latch() = 0;
  /// Bit l: SDA or SCL of line l is low while nobody drives it.
  [[nodiscard]] virtual std::uint8_t stuck_lines() const = 0;
};

}  // namespace triskin::sim
