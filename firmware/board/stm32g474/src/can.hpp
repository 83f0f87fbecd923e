// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::board {

/// Set of identifiers that the filters accept.
enum class CanFilters : std::uint8_t {
  kLoader,       ///< requests, the loader's own, iCub commands
  kApplication,  ///< also discovery, assignment and leases
};

/// FDCAN1 at 1 Mbit/s, data phase 2 Mbit/s, on PB8 and PB9. Both directions go through queues that the interrupt
/// serves. After a bus-off it stays away for a pause that doubles while it happens again: a board that disturbs the bus
/// must not do so without end.
class Stm32CanPort final : public fw::CanPort {
 public:
  void open(CanFilters filters);
  [[nodiscard]] bool fd() const override { return true; }
  bool send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive() override;
  [[nodiscard]] bool frame_waits() const;
  /// Joins the bus again after a bus-off, when its pause is over.
  void step(std::uint64_t now_us);
  /// When step() has work next, µs; UINT64_MAX: never.
  [[nodiscard]] std::uint64_t next_event_us() const { return rejoin_at_us_; }
  /// Adds error counters and state as they are now.
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
