// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <optional>

#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Models DMA1 with its request multiplexer (RM0440 §12, §13): eight channels that move bytes between a peripheral's
/// data register and RAM. A peripheral asks with its request number; the multiplexer finds the channel. Transfers take
/// no time of their own.
class Dma final : public Peripheral {
 public:
  /// The function returns null if there is no RAM at the address.
  using Memory = std::function<std::uint8_t*(std::uint32_t address)>;

  Dma(Surroundings& around, Memory memory) : Peripheral(around), memory_(std::move(memory)) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

  /// Returns the next byte for a peripheral that wants one; empty if no channel serves it now.
  [[nodiscard]] std::optional<std::uint8_t> fetch(std::uint32_t request);
  [[nodiscard]] bool wants(std::uint32_t request) { return channel_for(request, false) != nullptr; }
  void store(std::uint32_t request, std::uint8_t byte);

 private:
  friend class DmaMux;
  struct Channel {
    std::uint32_t control = 0, count = 0, reload = 0, peripheral = 0, memory = 0, at = 0, request = 0;
  };
  Channel* channel_for(std::uint32_t request, bool from_memory);
  [[nodiscard]] std::uint8_t* next_byte(Channel& c);

  Memory memory_;
  std::array<Channel, 8> channels_{};
};

/// Models DMAMUX (§13.6), which connects requests to channels.
class DmaMux final : public Peripheral {
 public:
  DmaMux(Surroundings& around, Dma& dma) : Peripheral(around), dma_(dma) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  Dma& dma_;
};

}  // namespace triskin::machine
