// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/usb_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "triskin/base/counted.hpp"
#include "triskin/base/short_list.hpp"

namespace triskin::link {

UsbLink::UsbLink(std::unique_ptr<UsbDriver> driver, const std::string& serial)
    : driver_(std::move(driver)), serial_(serial), name_(driver_->name() + (serial.empty() ? "" : ":" + serial)) {
  open_new_devices();
  if (devices_.empty()) {
    fail(fmt::format("no Triskin controller{} on USB; check cable and power; run: triskin doctor",
                     serial.empty() ? "" : " with this serial number"));
  }
}

void UsbLink::fail(const std::string& what) const {
  throw Unreachable(fmt::format("{}: {}", name_, what));
}

UsbLink::~UsbLink() {
  for (auto& d : devices_) d->reader.request_stop();
}

std::uint64_t UsbLink::now_us() const {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count());
}

std::vector<std::unique_ptr<UsbPipe>> UsbLink::new_pipes() {
  std::vector<std::string> places;
  for (const auto& d : devices_) places.push_back(d->pipe->place());
  try {
    return driver_->open(serial_, places);
  } catch (const DeviceError&) {
    // A device that was open before is still listed a moment after it was unplugged, and is listed before its
    // permissions are set when it returns. It is away then, which trouble() says.
    if (wires_ == 0) throw;
    return {};
  }
}

void UsbLink::open_new_devices() {
  last_scan_ = std::chrono::steady_clock::now();
  for (auto& pipe : new_pipes()) {
    auto device = std::make_unique<Device>();
    device->pipe = std::move(pipe);
    device->wire = ++wires_;
    {
      const std::lock_guard lock(mutex_);
      lost_.erase(device->pipe->serial());
    }
    Device& d = *device;
    devices_.push_back(std::move(device));
    d.reader = std::jthread([this, &d](const std::stop_token& stop) { read_all(d, stop); });
  }
}

void UsbLink::read_all(Device& device, const std::stop_token& stop) {
  constexpr int kTimeout_ms = 200;
  constexpr std::size_t kPackets = 16;
  std::array<std::uint8_t, kPackets * wire::kUsbPacketBytes> bytes{};
  try {
    while (!stop.stop_requested()) {
      const std::size_t n = device.pipe->read(bytes, kTimeout_ms);
      for (std::size_t at = 0; at < n; at += wire::kUsbPacketBytes) {
        const auto frame = wire::from_usb(Bytes(bytes).subspan(at, std::min(wire::kUsbPacketBytes, n - at)));
        if (!frame) continue;
        const std::lock_guard lock(mutex_);
        frames_.push_back(*frame);
        nodes_.heard(*frame, device.wire);
        came_.notify_one();
      }
    }
  } catch (const DeviceError&) {  // The device was unplugged; the owner of the link learns this in its own thread.
    const std::lock_guard lock(mutex_);
    device.gone = true;
    lost_.insert(device.pipe->serial());
    came_.notify_one();
  }
}

void UsbLink::remove_gone() {
  {
    const std::lock_guard lock(mutex_);
    if (std::ranges::none_of(devices_, [](const auto& d) { return d->gone; })) return;
  }
  std::erase_if(devices_, [this](const auto& d) {
    const std::lock_guard lock(mutex_);
    return d->gone;
  });
  if (devices_.empty()) open_new_devices();  // The device may have returned under another address.
}

void UsbLink::reconnect() {
  remove_gone();
  open_new_devices();
  if (devices_.empty()) fail(trouble());
}

int UsbLink::wire_of(std::uint8_t node) const {
  const std::lock_guard lock(mutex_);
  return nodes_.wire_of(node).value_or(0);
}

void UsbLink::send(const wire::CanFrame& frame) {
  remove_gone();
  if (devices_.empty()) fail(trouble());
  const auto packet = wire::to_usb(frame);
  if (!packet) throw DeviceError(fmt::format("{}: a frame of {} bytes does not fit a USB packet", name_, frame.size));
  const auto target = NodeMap::target_of(frame);
  std::optional<int> only;
  {
    const std::lock_guard lock(mutex_);
    if (target) only = nodes_.wire_of(*target);
    nodes_.sent(frame);
  }
  if (only && std::ranges::none_of(devices_, [&](const auto& d) { return d->wire == *only; })) fail(trouble());
  for (auto& d : devices_) {
    if (only && d->wire != *only) continue;
    try {
      d->pipe->write(*packet);
    } catch (const DeviceError&) {
      const std::lock_guard lock(mutex_);
      lost_.insert(d->pipe->serial());
      d->gone = true;
    }
  }
  remove_gone();
}

// Returns the next received frame, or none after a slice of the time or when a device was unplugged.
std::optional<wire::CanFrame> UsbLink::next_frame(std::uint64_t until_us) {
  std::unique_lock lock(mutex_);
  const auto until = std::min(start_ + std::chrono::microseconds(until_us), std::chrono::steady_clock::now() + kSlice);
  const auto ready = [&] {
    return !frames_.empty() || std::ranges::any_of(devices_, [](const auto& d) { return d->gone; });
  };
  (void)came_.wait_until(lock, until, ready);
  if (frames_.empty()) return std::nullopt;
  const wire::CanFrame frame = frames_.front();
  frames_.pop_front();
  return frame;
}

std::optional<wire::CanFrame> UsbLink::receive(std::uint64_t until_us) {
  while (true) {
    if (const auto frame = next_frame(std::min<std::uint64_t>(until_us, now_us() + 1'000'000))) return frame;
    remove_gone();
    const bool changed = driver_->changed();
    if (changed || (serial_.empty() && std::chrono::steady_clock::now() - last_scan_ > kScanEvery)) open_new_devices();
    if (devices_.empty()) fail(trouble());
    if (now_us() >= until_us) return std::nullopt;
  }
}

std::string UsbLink::trouble() const {
  const std::lock_guard lock(mutex_);
  if (lost_.empty()) return {};
  // A device that was pulled while it was being opened may not have told its serial number.
  std::vector<std::string> named(lost_.begin(), lost_.end());
  std::erase(named, "");
  if (named.empty()) return "a controller was unplugged; plug it in and run the command again";
  const bool one = named.size() == 1;
  return fmt::format("{} {} {} unplugged; plug {} in and run the command again", noun_after(one, "controller"),
                     short_list(named), one ? "was" : "were", one ? "it" : "them");
}

}  // namespace triskin::link
