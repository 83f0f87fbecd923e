// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <deque>
#include <functional>

#include "triskin/machine/can_node.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Models FDCAN1 and its message RAM (RM0440 §44): initialization rules, filters, receive FIFO 0 of three, transmit
/// FIFO of three, interrupts. Error states and bus-off follow §44.3.3.
class Fdcan final : public CanNode {
 public:
  Fdcan(Surroundings& around, Sink sink, VcdTrace* trace, std::function<bool()> pins_ready)
      : CanNode(around, std::move(sink), trace), pins_ready_(std::move(pins_ready)) {
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  void fail_ram() override;
  std::uint32_t read_ram(std::uint32_t offset) { return ram_[offset / 4]; }
  void write_ram(std::uint32_t offset, std::uint32_t value) { ram_[offset / 4] = value; }

 private:
  [[nodiscard]] bool running() const override { return (regs_[0x18 / 4] & 1) == 0; }
  [[nodiscard]] std::optional<wire::CanFrame> next_to_send() const override;
  void note_sent() override;
  void deliver(const wire::CanFrame& frame) override;
  void note_state(const State& before) override;
  [[nodiscard]] Time bit_time(bool data_phase) const override;
  void update_irqs() override;
  [[nodiscard]] std::uint32_t protocol_status() const;
  [[nodiscard]] wire::CanFrame read_element(std::uint32_t offset) const;
  void write_element(std::uint32_t offset, const wire::CanFrame& frame);
  [[nodiscard]] bool accepted(const wire::CanFrame& frame) const;
  void request(std::uint32_t mask);
  void check_start();

  std::function<bool()> pins_ready_;
  std::array<std::uint32_t, 80> regs_{};
  std::array<std::uint32_t, 0x350 / 4> ram_{};
  std::deque<std::uint32_t> to_send_;
  std::uint32_t fill_ = 0, get_ = 0, put_ = 0, tx_put_ = 0;
};

/// Maps the message RAM into the address space of the bus.
class FdcanRam final : public Peripheral {
 public:
  FdcanRam(Surroundings& around, Fdcan& can) : Peripheral(around), can_(can) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override {
    return check(offset, size) ? can_.read_ram(offset) : 0;
  }
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override {
    if (check(offset, size)) can_.write_ram(offset, value);
  }
  void reset() override {}

 private:
  bool check(std::uint32_t offset, unsigned size) {
    if (size == 4 && offset < 0x350) return true;
    around_.violation("FDCAN message RAM: not a whole word, or outside FDCAN1's part");
    return false;
  }
  Fdcan& can_;
};

}  // namespace triskin::machine
