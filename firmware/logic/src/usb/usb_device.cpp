// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/usb/usb_device.hpp"

namespace triskin::fw {
namespace {

// Class requests are from HID 1.11 §7.2 and DFU 1.1 §3.
constexpr std::uint8_t kClassOut = 0x21, kClassIn = 0xA1;
constexpr std::uint8_t kHidGetReport = 1, kHidGetIdle = 2, kHidGetProtocol = 3, kHidSetReport = 9, kHidSetIdle = 10;
constexpr std::uint8_t kDfuDetach = 0, kDfuGetStatus = 3, kDfuGetState = 5;
constexpr std::uint8_t kAppIdle = 0, kAppDetach = 1;
constexpr std::array<std::uint8_t, wire::kUsbPacketBytes> kNothing{};

}  // namespace

void UsbDevice::reset() {
  control_.reset();
  received_ = {};
  waiting_ = {};
  endpoint_ = 0;
  detach_ = false;
}

std::optional<Bytes> UsbDevice::control(const wire::UsbSetup& s, Bytes data) {
  static constexpr std::array<std::uint8_t, 1> kReportProtocol{1};
  if (s.index == wire::kHidInterface && s.type == kClassOut) {
    if (s.request == kHidSetIdle) {
      idle_ = static_cast<std::uint8_t>(s.value >> 8);
      return Bytes{};
    }
    if (s.request != kHidSetReport) return std::nullopt;
    out(wire::kHidOut, data);
    return Bytes{};
  }
  if (s.index == wire::kHidInterface && s.type == kClassIn) {
    if (s.request == kHidGetReport) return Bytes(kNothing);
    if (s.request == kHidGetIdle) return Bytes(&idle_, 1);
    if (s.request == kHidGetProtocol) return Bytes(kReportProtocol);
    return std::nullopt;
  }
  if (s.index == wire::kDfuInterface && s.type == kClassOut && s.request == kDfuDetach) {
    detach_ = true;
    return Bytes{};
  }
  if (s.index == wire::kDfuInterface && s.type == kClassIn) {
    static constexpr std::array<std::uint8_t, 6> kStatus[2]{{0, 0, 0, 0, kAppIdle, 0}, {0, 0, 0, 0, kAppDetach, 0}};
    const Bytes status = kStatus[detach_ ? 1 : 0];
    if (s.request == kDfuGetStatus) return status;
    if (s.request == kDfuGetState) return status.subspan(4, 1);
    return std::nullopt;
  }
  return control_.handle(s);
}

void UsbDevice::out(std::uint8_t endpoint, Bytes packet) {
  const auto frame = wire::from_usb(packet);
  if (!control_.configured() || !frame || received_.full()) return;
  if (endpoint != wire::kHidOut && endpoint != wire::kBulkOut) return;
  if (endpoint != endpoint_) waiting_ = {};  // The frames were meant for the user of the other interface.
  endpoint_ = endpoint;
  received_.push(*frame);
}

Bytes UsbDevice::in(std::uint8_t endpoint) {
  const bool hid = endpoint == wire::kHidIn;
  if (waiting_.count == 0 || (endpoint_ != (hid ? wire::kHidOut : wire::kBulkOut)) ||
      (!hid && endpoint != wire::kBulkIn))
    return {};
  leaving_ = waiting_.pop();
  // A full-length packet announces more packets, so that one transfer of the host carries many.
  return hid || waiting_.count != 0 ? Bytes(leaving_.bytes) : leaving_.used();
}

bool UsbDevice::send(const wire::CanFrame& frame) {
  if (!control_.configured() || endpoint_ == 0) return true;  // Without a listener the frame is lost, as on a bus.
  if (waiting_.full()) return false;
  if (const auto packet = wire::to_usb(frame)) waiting_.push(*packet);
  return true;
}

std::optional<wire::CanFrame> UsbDevice::receive() {
  if (received_.count == 0) return std::nullopt;
  return received_.pop();
}

}  // namespace triskin::fw
