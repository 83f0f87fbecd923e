// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/wire/unique_id.hpp"
#include "triskin/wire/usb_packet.hpp"

/// The controller's descriptors for a USB host follow USB 2.0 chapter 9, HID 1.11, DFU 1.1 and Microsoft OS 2.0
/// descriptors.
namespace triskin::fw::usb {

inline constexpr std::uint8_t kDevice = 1, kConfiguration = 2, kString = 3, kBos = 15, kHid = 0x21, kReport = 0x22;
/// A request with this bRequest fetches the Microsoft OS 2.0 set.
inline constexpr std::uint8_t kMicrosoftCode = 0x20;
inline constexpr std::uint16_t kMicrosoftSet = 7;  ///< This wIndex asks for the descriptor set.
inline constexpr std::uint16_t kDfuBlockBytes = 1024, kDetachTimeout_ms = 1000;
/// Strings have these indexes; kSerial is made from the unique id.
inline constexpr std::uint8_t kVendorText = 1, kProductText = 2, kSerial = 3, kHidText = 4, kBulkText = 5, kDfuText = 6,
                              kPackageText = 7;

/// Returns the descriptor. At run time it covers HID, vendor bulk and DFU run time, in DFU mode only the DFU interface.
[[nodiscard]] Bytes device_descriptor(bool dfu_mode);
/// Returns the constant configuration descriptor with all its interfaces and endpoints.
[[nodiscard]] Bytes configuration_descriptor(bool dfu_mode);
[[nodiscard]] Bytes hid_descriptor();
[[nodiscard]] Bytes hid_report_descriptor();
[[nodiscard]] Bytes bos_descriptor(bool dfu_mode);
[[nodiscard]] Bytes microsoft_set(bool dfu_mode);

/// Writes a string descriptor into `out` (UTF-16); returns an empty span if there is no such string.
[[nodiscard]] Bytes string_descriptor(std::uint8_t index, const wire::UniqueId& unique_id, std::span<std::uint8_t> out);

}  // namespace triskin::fw::usb
