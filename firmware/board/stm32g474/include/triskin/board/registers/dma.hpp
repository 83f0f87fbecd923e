// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// DMA1 and its request multiplexer, RM0440 §12.6, §13.6.
namespace triskin::board::dma_reg {

inline constexpr std::uint32_t kBase = 0x40020000, kMuxBase = 0x40020800;
// CCR
inline constexpr std::uint32_t kEnable = bit(0), kFromMemory = bit(4), kMemoryIncrement = bit(7);

/// Channel 0..7 of DMA1 (the manual counts from 1). Bytes from or to a peripheral's data register.
class Channel {
 public:
  /// `index` 0..7. Touches no register.
  constexpr explicit Channel(unsigned index) : base_(kBase + 0x08 + 20 * index), mux_(kMuxBase + 4 * index) {}
  /// Sets the request line (RM0440 table 91) and the address of the data register. The channel must be off.
  void connect(std::uint32_t request, std::uint32_t data_register) const {
    Register(mux_).write(request);
    Register(base_ + 8).write(data_register);
  }
  /// Switches the channel off; what it has moved stays.
  void stop() const { Register(base_).clear(kEnable); }
  /// Moves `bytes` (1..65535) between `memory` and the data register; `from_memory`: towards the peripheral. Stops the
  /// channel first.
  void start(std::uint32_t memory, std::uint32_t bytes, bool from_memory) const {
    stop();  // count and address are fixed while it is on
    Register(base_ + 4).write(bytes);
    Register(base_ + 12).write(memory);
    const std::uint32_t control = kMemoryIncrement | (from_memory ? kFromMemory : 0U);
    Register(base_).write(control);
    Register(base_).write(control | kEnable);
  }
  /// Bytes of the present transfer that have not been moved yet.
  [[nodiscard]] std::uint32_t remaining() const { return Register(base_ + 4).read(); }

 private:
  std::uint32_t base_, mux_;
};

/// Table 91: I²C 1..4 receive on 16, 18, 20, 22 and send on the number after that.
[[nodiscard]] constexpr std::uint32_t i2c_receive_request(unsigned line_index) {
  return 16 + 2 * line_index;
}

}  // namespace triskin::board::dma_reg
