// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// RM0440 §12.6 describes the DMA controller. How a request reaches a channel differs between the chips, so
/// connect_lines() does that.
namespace triskin::board::dma_reg {

inline constexpr std::uint32_t kBase = 0x40020000;
// The first channel begins at kFirstChannel, and channels are kChannelBytes apart.
inline constexpr std::uint32_t kFirstChannel = 0x08, kChannelBytes = 20;
inline constexpr std::uint32_t kCcr = 0x00, kCndtr = 0x04, kCpar = 0x08, kCmar = 0x0C;
// A DMA channel is configured by these bits of its register CCR.
inline constexpr std::uint32_t kEnable = bit(0), kFromMemory = bit(4), kMemoryIncrement = bit(7);

/// A channel moves bytes from or to a peripheral's data register. Numbers are 0..7, whereas the manual counts from 1.
class Channel {
 public:
  /// Stands for no channel.
  constexpr Channel() = default;
  /// `controller` is the base of a DMA controller, `index` is 0..7. The constructor touches no register.
  constexpr Channel(std::uint32_t controller, unsigned index)
      : base_(controller + kFirstChannel + kChannelBytes * index) {}
  /// Sets the address of the data register. The channel must be off.
  void connect(std::uint32_t data_register) const { Register(base_ + kCpar).write(data_register); }
  /// Switches the channel off; data that it has moved stay.
  void stop() const { Register(base_ + kCcr).clear(kEnable); }
  /// Moves `bytes` (1..65535) between `memory` and the data register; `from_memory` means towards the peripheral. Stops
  /// the channel first.
  void start(std::uint32_t memory, std::uint32_t bytes, bool from_memory) const {
    stop();  // Count and address can be changed only while the channel is off.
    Register(base_ + kCndtr).write(bytes);
    Register(base_ + kCmar).write(memory);
    const std::uint32_t control = kMemoryIncrement | (from_memory ? kFromMemory : 0U);
    Register(base_ + kCcr).write(control);
    Register(base_ + kCcr).write(control | kEnable);
  }
  /// Returns the bytes of the present transfer that have not been moved yet.
  [[nodiscard]] std::uint32_t remaining() const { return Register(base_ + kCndtr).read(); }

 private:
  std::uint32_t base_ = 0;
};

}  // namespace triskin::board::dma_reg
