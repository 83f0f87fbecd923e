// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <optional>

#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Models a DMA controller (RM0440 §12): eight channels that move bytes between a peripheral's data register and RAM.
/// A peripheral asks with its request number; the multiplexer (§13) finds the channel. Transfers take no time of their
/// own.
class Dma : public Peripheral {
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

 protected:
  friend class DmaMux;
  struct Channel {
    std::uint32_t control = 0, count = 0, reload = 0, peripheral = 0, memory = 0, at = 0, request = 0;
  };
  std::array<Channel, 8> channels_{};

 private:
  Channel* channel_for(std::uint32_t request, bool from_memory);
  [[nodiscard]] std::uint8_t* next_byte(Channel& c);

  Memory memory_;
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

/// Models a DMA controller of the STM32L4, which has seven channels; CSELR selects one of the fixed requests of each
/// (RM0394, chapter on DMA). Requests of the I²C blocks have the numbers of RM0440 here.
class SelectingDma final : public Dma {
 public:
  /// `controller` is 1 or 2.
  SelectingDma(Surroundings& around, Memory memory, int controller)
      : Dma(around, std::move(memory)), controller_(controller) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  void select(std::uint32_t value);
  int controller_;
  std::uint32_t selection_ = 0;
};

}  // namespace triskin::machine
