// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/usb/usb_control.hpp"

#include "triskin/logic/usb/usb_descriptors.hpp"

namespace triskin::fw {
namespace {

constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kGetDescriptor = 6, kGetConfiguration = 8,
                       kSetConfiguration = 9, kGetInterface = 10, kSetInterface = 11;
constexpr std::uint8_t kDeviceIn = 0x80, kInterfaceIn = 0x81, kEndpointIn = 0x82, kDeviceOut = 0x00,
                       kInterfaceOut = 0x01, kEndpointOut = 0x02, kVendorIn = 0xC0;

}  // namespace

std::optional<Bytes> UsbControl::descriptor(const wire::UsbSetup& s) {
  const auto kind = static_cast<std::uint8_t>(s.value >> 8), which = static_cast<std::uint8_t>(s.value & 0xFF);
  if (s.type == kInterfaceIn) {
    if (dfu_mode_ || s.index != wire::kHidInterface) return std::nullopt;
    if (kind == usb::kReport) return usb::hid_report_descriptor();
    if (kind == usb::kHid) return usb::hid_descriptor();
    return std::nullopt;
  }
  switch (kind) {
    case usb::kDevice:
      return usb::device_descriptor(dfu_mode_);
    case usb::kConfiguration:
      return which == 0 ? std::optional(usb::configuration_descriptor(dfu_mode_)) : std::nullopt;
    case usb::kBos:
      return usb::bos_descriptor(dfu_mode_);
    case usb::kString: {
      const Bytes text = usb::string_descriptor(which, unique_id_, reply_);
      return text.empty() ? std::nullopt : std::optional(text);
    }
    default:
      return std::nullopt;  // This includes the qualifier, because the device is full speed only.
  }
}

std::optional<Bytes> UsbControl::handle(const wire::UsbSetup& s) {
  const auto answer = [&](std::initializer_list<std::uint8_t> bytes) {
    std::copy(bytes.begin(), bytes.end(), reply_.begin());
    return std::optional(Bytes(reply_).first(bytes.size()));
  };
  if (s.request == kGetDescriptor && (s.type == kDeviceIn || s.type == kInterfaceIn)) return descriptor(s);
  if (s.type == kVendorIn && s.request == usb::kMicrosoftCode && s.index == usb::kMicrosoftSet)
    return usb::microsoft_set(dfu_mode_);
  if (s.request == kGetStatus && s.type == kDeviceIn) return answer({1, 0});  // The device is self-powered.
  if (s.request == kGetStatus && (s.type == kInterfaceIn || s.type == kEndpointIn)) return answer({0, 0});
  if (s.type == kDeviceIn && s.request == kGetConfiguration) return answer({configuration_});
  if (s.type == kDeviceOut && s.request == kSetConfiguration) {
    if (s.value > 1) return std::nullopt;
    configuration_ = static_cast<std::uint8_t>(s.value);
    return Bytes{};
  }
  if (s.type == kInterfaceIn && s.request == kGetInterface && s.index < interfaces()) return answer({0});
  if (s.type == kInterfaceOut && s.request == kSetInterface && s.index < interfaces() && s.value == 0) return Bytes{};
  if (s.type == kEndpointOut && s.request == kClearFeature && s.value == 0) return Bytes{};  // End points never halt.
  return std::nullopt;
}

}  // namespace triskin::fw
