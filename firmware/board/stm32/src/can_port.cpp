// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "can.hpp"
#include "interrupt_timer.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

Stm32CanPort can;

namespace {

template <std::size_t N>
struct Queue {
  std::array<wire::CanFrame, N> frames;
  volatile std::size_t head = 0, tail = 0;
  [[nodiscard]] bool full() const { return (head + 1) % N == tail; }
};
// The queue is not a member of the port: with its table of functions the port has initial values, which are stored in
// the flash.
constinit Queue<32> received;
constinit Queue<16> waiting;

// Off the bus frames wait.
void fill_transmit_buffers() {
  while (waiting.head != waiting.tail && can_block::transmit(waiting.frames[waiting.tail]))
    waiting.tail = (waiting.tail + 1) % waiting.frames.size();
}

// Frames for which the queue has no room are lost.
void empty_receive_buffers() {
  wire::CanFrame no_room;
  for (;;) {
    const bool full = received.full();
    if (!can_block::take_frame(full ? no_room : received.frames[received.head])) return;
    if (full)
      ++triskin_budget.can_lost;
    else
      received.head = (received.head + 1) % received.frames.size();
  }
}

}  // namespace

void open_can_pins() {
  for (const Pin pin : {pins::kCanReceive, pins::kCanSend}) {
    open_port(pin);
    Gpio(pin).very_high_speed();
    Gpio(pin).alternate(pins::kFunctionCan);
    Gpio(pin).mode(PinMode::kAlternate);
  }
}

void Stm32CanPort::open(CanFilters filters) {
  can_block::open(filters);
}

bool Stm32CanPort::fd() const {
  return can_block::fd();
}

bool Stm32CanPort::send(const wire::CanFrame& frame) {
  const InterruptLock lock;
  if (waiting.full()) return false;
  waiting.frames[waiting.head] = frame;
  waiting.head = (waiting.head + 1) % waiting.frames.size();
  fill_transmit_buffers();
  return true;
}

bool Stm32CanPort::has_room() const {
  return !waiting.full();
}

bool Stm32CanPort::frame_waits() const {
  return received.head != received.tail;
}

std::optional<wire::CanFrame> Stm32CanPort::receive() {
  const InterruptLock lock;
  if (received.head == received.tail) return std::nullopt;
  const wire::CanFrame frame = received.frames[received.tail];
  received.tail = (received.tail + 1) % received.frames.size();
  return frame;
}

void Stm32CanPort::note_bus_off() {
  constexpr std::uint64_t kFirstPause_us = 10'000, kMaxPause_us = 1'000'000, kCalm_us = 5'000'000;
  const std::uint64_t now_us = microseconds();
  bus_offs_ = bus_offs_ + 1;
  const bool calm = pause_us_ == 0 || now_us > joined_at_us_ + kCalm_us;
  pause_us_ = calm ? kFirstPause_us : std::min(2 * pause_us_, kMaxPause_us);
  rejoin_at_us_ = now_us + pause_us_;
}

void Stm32CanPort::step(std::uint64_t now_us) {
  const InterruptLock lock;
  if (now_us < rejoin_at_us_) return;
  rejoin_at_us_ = UINT64_MAX;
  joined_at_us_ = now_us;
  can_block::rejoin();
  fill_transmit_buffers();
}

void Stm32CanPort::describe(wire::BoardHealth& h) const {
  can_block::describe(h);
  h.bus_offs = bus_offs_;
  h.can_ram_failures = ram_failures_;
  h.can_lost = triskin_budget.can_lost;
}

void Stm32CanPort::on_interrupt() {
  const can_block::Events events = can_block::take_events();
  if (events.frame_lost) ++triskin_budget.can_lost;
  if (events.ram_failed) ram_failures_ = static_cast<std::uint16_t>(ram_failures_ + 1);
  if (events.bus_off) note_bus_off();
  empty_receive_buffers();
  fill_transmit_buffers();
}

}  // namespace triskin::board

extern "C" void can_handler() {
  const triskin::board::InterruptTimer timer;
  triskin::board::can.on_interrupt();
}
