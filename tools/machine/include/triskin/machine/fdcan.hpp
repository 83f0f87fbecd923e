// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <deque>
#include <functional>

#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/vcd.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Models FDCAN1 and its message RAM (RM0440 §44): initialization rules, filters, receive FIFO 0 of three, transmit
/// FIFO of three, interrupts. Frames take the time of their bits, including stuff bits, at the programmed rates. An
/// error frame follows a spoilt frame, which is sent again; error counters, error states and bus-off follow §44.3.3.
class Fdcan final : public Peripheral {
 public:
  using Sink = std::function<void(const wire::CanFrame&, std::uint64_t now_us)>;
  Fdcan(Surroundings& around, Sink sink, VcdTrace* trace, std::function<bool()> pins_ready)
      : Peripheral(around), sink_(std::move(sink)), trace_(trace), pins_ready_(std::move(pins_ready)) {
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  std::uint32_t read_ram(std::uint32_t offset) { return ram_[offset / 4]; }
  void write_ram(std::uint32_t offset, std::uint32_t value) { ram_[offset / 4] = value; }
  /// Takes a frame from another node, which waits its turn on the bus.
  void from_bus(const wire::CanFrame& frame);
  /// Returns the number of frames of other nodes that have not ended on the bus.
  [[nodiscard]] std::size_t waiting() const { return incoming_.size(); }
  /// Spoils the frame that is under way: an error frame follows, and its sender begins again. Returns false if the bus
  /// is idle.
  bool spoil_frame();
  /// Returns how often it left the bus.
  [[nodiscard]] std::uint64_t bus_offs() const { return bus_offs_; }

 private:
  [[nodiscard]] Time nominal_bit() const;
  [[nodiscard]] Time frame_time(const wire::CanFrame& frame) const;
  void count_error();
  void count_success(bool mine);
  void leave_bus();
  void rejoin();
  [[nodiscard]] std::uint32_t protocol_status() const;
  void end_frame(bool mine, const wire::CanFrame& frame);
  [[nodiscard]] wire::CanFrame read_element(std::uint32_t offset) const;
  void write_element(std::uint32_t offset, const wire::CanFrame& frame);
  [[nodiscard]] bool accepted(const wire::CanFrame& frame) const;
  void deliver(const wire::CanFrame& frame);
  void next_on_bus();
  void sent(std::uint32_t index, const wire::CanFrame& frame);
  void request(std::uint32_t mask);
  void check_start();
  [[nodiscard]] bool running() const { return (regs_[0x18 / 4] & 1) == 0; }
  void update_irqs();

  Sink sink_;
  VcdTrace* trace_;
  std::function<bool()> pins_ready_;
  std::array<std::uint32_t, 80> regs_{};
  std::array<std::uint32_t, 0x350 / 4> ram_{};
  std::deque<wire::CanFrame> incoming_;
  std::deque<std::uint32_t> to_send_;
  std::uint32_t fill_ = 0, get_ = 0, put_ = 0, tx_put_ = 0;
  bool bus_busy_ = false, own_frame_ = false, bus_off_ = false;
  std::uint32_t send_errors_ = 0, receive_errors_ = 0;
  std::uint64_t bus_offs_ = 0;
  Time joins_at_ = 0;  // After bus-off no frame is sent before this time.
  std::uint64_t generation_ = 0;
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
