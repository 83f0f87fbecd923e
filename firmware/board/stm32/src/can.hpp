// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"
#include "triskin/wire/health.hpp"

namespace triskin::board {

enum class CanFilters : std::uint8_t {
  kLoader,       ///< The filters pass requests, the loader's own frames and iCub commands.
  kApplication,  ///< The filters also pass discovery, assignment and leases.
};

/// The port is the CAN block of the chip, at 1 Mbit/s and, with FD frames, 2 Mbit/s in the data phase. Both directions
/// use queues that the interrupt serves. After a bus-off it stays off the bus for a pause that doubles each time,
/// because a board that disturbs the bus must not do so for ever.
class Stm32CanPort final : public fw::CanPort {
 public:
  void open(CanFilters filters);
  [[nodiscard]] bool fd() const override;
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

/// Gives the pins of the CAN port to the block.
void open_can_pins();

/// Each chip implements the rest for its CAN block. The port calls these functions with interrupts disabled, or from
/// the interrupt of the block.
namespace can_block {

/// True means that the block sends and receives FD frames.
[[nodiscard]] bool fd();
/// Starts the block with its pins, bit timing, filters and interrupts.
void open(CanFilters filters);
/// What has happened since the last call.
struct Events {
  bool frame_lost = false;  ///< A frame arrived while the receive FIFO was full.
  bool ram_failed = false;  ///< The block could not access its message RAM in time.
  bool bus_off = false;     ///< The block has left the bus because of its errors.
};
[[nodiscard]] Events take_events();
/// Takes the oldest frame of the receive FIFO. Returns false if there is none.
[[nodiscard]] bool take_frame(wire::CanFrame& frame);
/// Requests a transmission, in the order of the calls. Returns false if no buffer is free, or the block is off the bus.
[[nodiscard]] bool transmit(const wire::CanFrame& frame);
/// Ends a bus-off. The block sends again when it has seen eleven recessive bits 128 times.
void rejoin();
/// Adds error counters, last error and state.
void describe(wire::BoardHealth& health);

}  // namespace can_block

}  // namespace triskin::board
