// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::board {

enum class CanFilters : std::uint8_t {
  kLoader,       ///< The filters pass requests, the loader's own frames and iCub commands.
  kApplication,  ///< The filters also pass discovery, assignment and leases.
};

/// The port is FDCAN1 on PB8 and PB9, at 1 Mbit/s and 2 Mbit/s in the data phase. Both directions use queues that the
/// interrupt serves. After a bus-off it stays off the bus for a pause that doubles each time, because a board that
/// disturbs the bus must not do so for ever.
class Stm32CanPort final : public fw::CanPort {
 public:
  void open(CanFilters filters);
  [[nodiscard]] bool fd() const override { return true; }
  bool send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive() override;
  [[nodiscard]] bool frame_waits() const;
  /// Rejoins the bus after a bus-off, when the pause is over.
  void step(std::uint64_t now_us);
  /// Returns when step() has work next in µs; UINT64_MAX means never.
  [[nodiscard]] std::uint64_t next_event_us() const { return rejoin_at_us_; }
  /// Adds the present error counters and state.
  void describe(wire::BoardHealth& health) const;
  [[nodiscard]] bool has_room() const override;
  void on_interrupt();

 private:
  void note_bus_off();

  volatile std::uint64_t rejoin_at_us_ = UINT64_MAX;
  std::uint64_t pause_us_ = 0, joined_at_us_ = 0;
  volatile std::uint32_t bus_offs_ = 0;
  volatile std::uint16_t ram_failures_ = 0;
};

extern Stm32CanPort can;

}  // namespace triskin::board
