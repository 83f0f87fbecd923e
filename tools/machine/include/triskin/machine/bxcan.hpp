// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <deque>
#include <functional>

#include "triskin/machine/can_node.hpp"

namespace triskin::machine {

/// Models bxCAN of the STM32L4 (RM0394, chapter on bxCAN): modes, bit timing, filters of 32 bits with a mask, FIFO 0 of
/// three frames, three mailboxes in the order of their requests or by identifier, interrupts, bus-off that ends by a
/// visit to initialization. A frame with a data phase on its bus is a violation, because a classic node destroys it.
class Bxcan final : public CanNode {
 public:
  Bxcan(Surroundings& around, Sink sink, VcdTrace* trace, std::function<bool()> pins_ready)
      : CanNode(around, std::move(sink), trace), pins_ready_(std::move(pins_ready)) {
    reset();
  }
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  static constexpr std::size_t kDepth = 3, kBanks = 14;
  using Element = std::array<std::uint32_t, 4>;  // Identifier, length, and two words of data.
  enum class Mode : std::uint8_t { kSleep, kInitialization, kNormal };

  [[nodiscard]] bool running() const override { return mode_ == Mode::kNormal && !bus_off(); }
  [[nodiscard]] std::optional<wire::CanFrame> next_to_send() const override;
  void note_sent() override;
  void deliver(const wire::CanFrame& frame) override;
  void note_state(const State& before) override;
  [[nodiscard]] Time bit_time(bool data_phase) const override;
  void update_irqs() override;

  [[nodiscard]] std::size_t next_mailbox() const;
  [[nodiscard]] std::uint32_t transmit_status() const;
  [[nodiscard]] std::uint32_t error_status() const;
  [[nodiscard]] bool accepted(std::uint32_t identifier) const;
  void write_mode(std::uint32_t value);
  void enter_initialization();
  void leave_initialization();
  void write_mailbox(std::uint32_t offset, std::uint32_t value);
  void write_filter(std::uint32_t offset, std::uint32_t value);
  void clear_requests(std::uint32_t value);

  std::function<bool()> pins_ready_;
  Mode mode_ = Mode::kSleep;
  std::uint32_t control_ = 0, interrupts_ = 0, timing_ = 0;
  bool error_interrupt_ = false, overrun_ = false;
  std::array<Element, kDepth> mailboxes_{};
  std::array<bool, kDepth> pending_{}, completed_{};
  std::deque<std::size_t> requests_;
  std::deque<Element> fifo_;
  std::uint32_t filter_init_ = 1, filter_mode_ = 0, filter_scale_ = 0, filter_fifo_ = 0, filter_active_ = 0;
  std::array<std::array<std::uint32_t, 2>, kBanks> banks_{};
};

}  // namespace triskin::machine
