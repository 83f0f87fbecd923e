// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/vcd.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Models what every CAN controller does on the bus that it shares with other nodes: one frame at a time, the lower
/// identifier first, in the time of its bits including stuff bits. An error frame follows a spoilt frame, which is sent
/// again; error counters, error states and bus-off are those of ISO 11898-1. A chip's block adds its registers.
class CanNode : public Peripheral {
 public:
  using Sink = std::function<void(const wire::CanFrame&, std::uint64_t now_us)>;
  CanNode(Surroundings& around, Sink sink, VcdTrace* trace)
      : Peripheral(around), sink_(std::move(sink)), trace_(trace) {}
  /// Takes a frame from another node, which waits its turn on the bus.
  void from_bus(const wire::CanFrame& frame);
  /// Returns the number of frames of other nodes that have not ended on the bus.
  [[nodiscard]] std::size_t waiting() const { return incoming_.size(); }
  /// Spoils the frame that is under way: an error frame follows, and its sender begins again. Returns false if the bus
  /// is idle.
  bool spoil_frame();
  /// The block could not read its message RAM in time; a block without such a RAM ignores this.
  virtual void fail_ram() {}
  /// Returns how often it left the bus.
  [[nodiscard]] std::uint64_t bus_offs() const { return bus_offs_; }

 protected:
  struct State {
    bool warning = false, passive = false, off = false;
    bool operator==(const State&) const = default;
  };
  /// Returns true if the block takes part in the bus.
  [[nodiscard]] virtual bool running() const = 0;
  /// Returns the frame that the block sends next; empty if it has none.
  [[nodiscard]] virtual std::optional<wire::CanFrame> next_to_send() const = 0;
  /// The frame of next_to_send() was acknowledged.
  virtual void note_sent() = 0;
  /// Receives a frame of another node.
  virtual void deliver(const wire::CanFrame& frame) = 0;
  /// An error has changed the state.
  virtual void note_state(const State& before) = 0;
  /// Returns the time of a bit, at the rate of the data phase or at the nominal one.
  [[nodiscard]] virtual Time bit_time(bool data_phase) const = 0;
  virtual void update_irqs() = 0;

  /// Leaves the bus as after a reset.
  void reset_bus();
  /// Sends or receives the next frame if the bus is idle.
  void next_on_bus();
  /// Returns after bus-off, once eleven recessive bits were seen 129 times.
  void rejoin();
  [[nodiscard]] State state() const;
  [[nodiscard]] bool bus_off() const { return bus_off_; }
  /// Returns true while the block waits for the recessive bits that end a bus-off.
  [[nodiscard]] bool recovers() const { return around_.time().now() < joins_at_; }
  [[nodiscard]] bool bus_busy() const { return bus_busy_; }
  [[nodiscard]] std::uint32_t send_errors() const { return send_errors_; }
  [[nodiscard]] std::uint32_t receive_errors() const { return receive_errors_; }
  /// Runs `action` later unless the block is reset before.
  void after(Time delay, std::function<void()> action);

 private:
  void count_error();
  void end_frame(bool mine, const wire::CanFrame& frame);

  Sink sink_;
  VcdTrace* trace_;
  std::deque<wire::CanFrame> incoming_;
  bool bus_busy_ = false, own_frame_ = false, bus_off_ = false;
  std::uint32_t send_errors_ = 0, receive_errors_ = 0;
  std::uint64_t bus_offs_ = 0;
  Time joins_at_ = 0;  // After bus-off no frame is sent before this time.
  std::uint64_t frame_generation_ = 0, reset_generation_ = 0;
};

}  // namespace triskin::machine
