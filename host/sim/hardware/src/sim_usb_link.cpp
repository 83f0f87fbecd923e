// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "triskin/hardware/sim_link.hpp"

namespace triskin::hardware {
namespace {

constexpr std::uint64_t kAsk_us = 125;  // A device without data is asked again in the next microframe.
// The request is SET_CONFIGURATION of USB 2.0, table 9-4.
constexpr wire::UsbSetup kConfigure{.type = 0, .request = 9, .value = 1};
constexpr int kNotConfigured = -1;

hardware::Scene without_bus(hardware::Scene scene) {
  scene.effects.bus_bit_rate = 0;
  scene.effects.bus_data_bit_rate = 0;
  return scene;
}

}  // namespace

SimUsbLink::SimUsbLink(hardware::Scene scene, const std::filesystem::path& state_folder)
    : InProcessLink(without_bus(std::move(scene)), state_folder), sessions_(skin_.controllers(), kNotConfigured) {
  skin_.on_delivery([](std::size_t, const wire::CanFrame&) { return false; });  // The CAN ports are not connected.
}

// The host configures a device when it is plugged in.
bool SimUsbLink::ready(std::size_t device) {
  if (!skin_.alive(device)) return false;
  const int session = skin_.usb_session(device);
  if (session != sessions_[device]) {
    skin_.usb(device).reset();
    (void)skin_.usb(device).control(kConfigure, {});
    sessions_[device] = session;
  }
  return true;
}

void SimUsbLink::occupy_hub() {
  hub_free_ns_ = std::max(hub_free_ns_, 1000 * skin_.now_us()) + wire::kUsbBulkFrame_ns;
  ++packets_;
}

void SimUsbLink::wait_for_hub() {
  skin_.run_until((hub_free_ns_ + 999) / 1000);
}

void SimUsbLink::send(const wire::CanFrame& frame) {
  const auto packet = wire::to_usb(frame);
  if (!packet) throw DeviceError(fmt::format("{}: a frame of {} bytes does not fit a USB packet", name(), frame.size));
  const auto target = link::NodeMap::target_of(frame);
  const auto only = target ? nodes_.wire_of(*target) : std::nullopt;
  nodes_.sent(frame);
  for (std::size_t device = 0; device < sessions_.size(); ++device) {
    if ((only && *only != static_cast<int>(device) + 1) || !ready(device)) continue;
    wait_for_hub();
    skin_.usb(device).out(wire::kBulkOut, packet->used());
    skin_.wake(device);
    occupy_hub();
  }
}

// Transfers one packet of the next device in turn that has one.
bool SimUsbLink::fetch() {
  for (std::size_t k = 0; k < sessions_.size(); ++k) {
    const std::size_t device = (next_ + k) % sessions_.size();
    if (!ready(device)) continue;
    const auto frame = wire::from_usb(skin_.usb(device).in(wire::kBulkIn));
    if (!frame) continue;
    skin_.wake(device);  // The device has room for another packet.
    nodes_.heard(*frame, static_cast<int>(device) + 1);
    inbox_.push_back(*frame);
    next_ = device + 1;
    occupy_hub();
    return true;
  }
  return false;
}

std::optional<wire::CanFrame> SimUsbLink::receive(std::uint64_t until_us) {
  while (inbox_.empty()) {
    if (1000 * skin_.now_us() >= hub_free_ns_ && fetch()) break;
    if (skin_.now_us() >= until_us) return std::nullopt;
    const std::uint64_t free_us = (hub_free_ns_ + 999) / 1000;
    skin_.run_until(std::min(until_us, free_us > skin_.now_us() ? free_us : skin_.now_us() + kAsk_us));
  }
  const wire::CanFrame frame = inbox_.front();
  inbox_.pop_front();
  return frame;
}

}  // namespace triskin::hardware
