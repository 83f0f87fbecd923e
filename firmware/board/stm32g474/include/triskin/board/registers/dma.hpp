// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// DMA1 and its request multiplexer are described in RM0440 §12.6 and §13.6.
namespace triskin::board::dma_reg {

inline constexpr std::uint32_t kBase = 0x40020000, kMuxBase = 0x40020800;
// The first channel begins at kFirstChannel, and channels are kChannelBytes apart.
inline constexpr std::uint32_t kFirstChannel = 0x08, kChannelBytes = 20, kMuxChannelBytes = 4;
inline constexpr std::uint32_t kCcr = 0x00, kCndtr = 0x04, kCpar = 0x08, kCmar = 0x0C;
// Requests of I2C1 are from table 91; each further line has the next two.
inline constexpr std::uint32_t kI2c1Receive = 16, kI2c1Send = 17, kI2cRequests = 2;
// A DMA channel is configured by these bits of its register CCR.
inline constexpr std::uint32_t kEnable = bit(0), kFromMemory = bit(4), kMemoryIncrement = bit(7);

/// A channel of DMA1 moves bytes from or to a peripheral's data register. Numbers are 0..7, whereas the manual counts
/// from 1.
class Channel {
 public:
  /// `index` is 0..7. The constructor touches no register.
  constexpr explicit Channel(unsigned index)
      : base_(kBase + kFirstChannel + kChannelBytes * index), mux_(kMuxBase + kMuxChannelBytes * index) {}
  /// Sets the request line (RM0440 chapter 13) and the address of the data register. The channel must be off.
  void connect(std::uint32_t request, std::uint32_t data_register) const {
    Register(mux_).write(request);
    Register(base_ + kCpar).write(data_register);
  }
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
  std::uint32_t base_, mux_;
};

[[nodiscard]] constexpr std::uint32_t i2c_receive_request(unsigned line_index) {
  return kI2c1Receive + kI2cRequests * line_index;
}
[[nodiscard]] constexpr std::uint32_t i2c_send_request(unsigned line_index) {
  return kI2c1Send + kI2cRequests * line_index;
}

}  // namespace triskin::board::dma_reg
