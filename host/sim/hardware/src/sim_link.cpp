// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/sim_link.hpp"

#include "triskin/wire/uds.hpp"

namespace triskin::hardware {

std::uint64_t InProcessLink::answer_us() const {
  return 2 * wire::kP2_us;
}

void InProcessLink::press(layout::ModuleId module) {
  lift();
  touch_ = skin_.press_module(module);
}

void InProcessLink::press(layout::TaxelId taxel) {
  lift();
  touch_ = skin_.press_taxel(taxel);
}

void InProcessLink::lift() {
  if (touch_ != 0) skin_.release(touch_);
  touch_ = 0;
}

SimLink::SimLink(hardware::Scene scene, const std::filesystem::path& state_folder)
    : InProcessLink(std::move(scene), state_folder) {
  skin_.on_frame([this](const wire::CanFrame& frame, std::uint64_t) { inbox_.push_back(frame); });
}

// If the bus is full, the sender waits, as with the queue of a CAN adapter.
void SimLink::send(const wire::CanFrame& frame) {
  constexpr std::size_t kQueue = 64;
  constexpr std::uint64_t kLook_us = 100;
  while (skin_.host_frames_waiting() >= kQueue) skin_.run_until(skin_.now_us() + kLook_us);
  skin_.send(frame);
}

std::optional<wire::CanFrame> SimLink::receive(std::uint64_t until_us) {
  if (inbox_.empty()) skin_.run_until_frame(until_us);
  if (inbox_.empty()) return std::nullopt;
  const wire::CanFrame frame = inbox_.front();
  inbox_.pop_front();
  return frame;
}

}  // namespace triskin::hardware
