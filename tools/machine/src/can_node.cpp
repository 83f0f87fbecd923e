// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/can_node.hpp"

#include <algorithm>

#include "triskin/machine/can_bits.hpp"

namespace triskin::machine {
namespace {

// ISO 11898-1 defines these limits of the error counters.
constexpr std::uint32_t kWarning = 96, kPassive = 128, kOff = 256;

// The lower value wins the bus: an 11-bit identifier before a 29-bit one with equal leading bits.
std::uint64_t rank(const wire::CanFrame& f) {
  return f.extended ? static_cast<std::uint64_t>(f.id) << 1 | 1 : static_cast<std::uint64_t>(f.id) << 19;
}

}  // namespace

void CanNode::reset_bus() {
  ++frame_generation_;
  ++reset_generation_;
  incoming_.clear();
  bus_busy_ = bus_off_ = false;
  send_errors_ = receive_errors_ = 0;
  joins_at_ = 0;
}

void CanNode::after(Time delay, std::function<void()> action) {
  around_.time().after(delay, [this, g = reset_generation_, action = std::move(action)] {
    if (g == reset_generation_) action();
  });
}

CanNode::State CanNode::state() const {
  const std::uint32_t most = std::max(send_errors_, receive_errors_);
  return {most >= kWarning, most >= kPassive, bus_off_};
}

// A node that sees an error counts eight while it sends and one while it receives; each frame without error subtracts
// one. At bus-off the block stops by itself.
void CanNode::count_error() {
  const State before = state();
  if (own_frame_)
    send_errors_ += 8;
  else
    receive_errors_ = std::min(receive_errors_ + 1, kPassive);
  if (send_errors_ >= kOff) {
    bus_off_ = true;
    ++bus_offs_;
  }
  note_state(before);
}

void CanNode::rejoin() {
  const Time wait = bit_time(false) * (129 * 11);
  bus_off_ = false;
  send_errors_ = receive_errors_ = 0;
  joins_at_ = around_.time().now() + wait;
  after(wait, [this] { next_on_bus(); });
}

bool CanNode::spoil_frame() {
  if (!bus_busy_ || !running()) return false;
  ++frame_generation_;  // The new generation cancels the end of the frame.
  count_error();
  after(bit_time(false) * kErrorFrameBits, [this, g = frame_generation_] {
    if (g != frame_generation_) return;
    bus_busy_ = false;
    if (trace_ != nullptr) trace_->can_busy(false, around_.time().now());
    next_on_bus();
  });
  update_irqs();
  return true;
}

void CanNode::from_bus(const wire::CanFrame& frame) {
  incoming_.push_back(frame);
  next_on_bus();
}

void CanNode::next_on_bus() {
  if (bus_busy_ || recovers()) return;
  const auto own = running() ? next_to_send() : std::nullopt;
  if (incoming_.empty() && !own) return;
  const bool mine = own && (incoming_.empty() || rank(*own) < rank(incoming_.front()));
  const wire::CanFrame frame = mine ? *own : incoming_.front();
  bus_busy_ = true;
  own_frame_ = mine;
  if (trace_ != nullptr) trace_->can_busy(mine, around_.time().now());
  const CanBits bits = can_bits(frame);
  after(bit_time(false) * bits.nominal + bit_time(true) * bits.data, [this, mine, frame, g = frame_generation_] {
    if (g == frame_generation_) end_frame(mine, frame);
  });
}

void CanNode::end_frame(bool mine, const wire::CanFrame& frame) {
  bus_busy_ = false;
  if (trace_ != nullptr) trace_->can_busy(false, around_.time().now());
  std::uint32_t& errors = mine ? send_errors_ : receive_errors_;
  errors -= std::min(errors, 1U);
  if (mine) {
    note_sent();
    update_irqs();
    if (sink_) sink_(frame, around_.time().now_us());
  } else {
    incoming_.pop_front();
    deliver(frame);
  }
  next_on_bus();
}

}  // namespace triskin::machine
