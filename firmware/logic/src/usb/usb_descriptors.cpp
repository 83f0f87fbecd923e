// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/usb/usb_descriptors.hpp"

#include <string_view>

namespace triskin::fw::usb {
namespace {

using namespace wire;

constexpr std::uint8_t low(std::size_t v) {
  return static_cast<std::uint8_t>(v & 0xFF);
}
constexpr std::uint8_t high(std::size_t v) {
  return static_cast<std::uint8_t>(v >> 8 & 0xFF);
}

constexpr std::array<std::uint8_t, 18> make_device(std::uint16_t product) {
  // With bcdUSB 2.1 the host asks for the BOS descriptor; 0x0100 is the release of the device.
  return {18,
          kDevice,
          0x10,
          0x02,
          0,
          0,
          0,
          64,
          low(kUsbVendor),
          high(kUsbVendor),
          low(product),
          high(product),
          0x00,
          0x01,
          kVendorText,
          kProductText,
          kSerial,
          1};
}
constexpr auto kRunTimeDevice = make_device(kUsbProduct), kDfuDevice = make_device(kUsbDfuProduct);

// The report has the vendor page, no report id, and 64 bytes in each direction.
constexpr std::array<std::uint8_t, 34> kHidReport{
    0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x09, 0x02, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95,
    0x40, 0x81, 0x02, 0x09, 0x03, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 0x40, 0x91, 0x02, 0xC0};

// In DFU mode the device can download but not upload and is manifestation tolerant. At run time it detaches by itself.
constexpr std::uint8_t kDfuAttributes = 0x05, kWillDetach = 0x08;

constexpr std::size_t kRunTimeBytes = 9 + (9 + 9 + 7 + 7) + (9 + 7 + 7) + (9 + 9);
constexpr std::array<std::uint8_t, kRunTimeBytes> kRunTimeConfiguration{9,
                                                                        kConfiguration,
                                                                        low(kRunTimeBytes),
                                                                        high(kRunTimeBytes),
                                                                        3,
                                                                        1,
                                                                        0,
                                                                        0xC0,  // The bus's 5 V are not connected.
                                                                        0,
                                                                        9,
                                                                        4,
                                                                        kHidInterface,
                                                                        0,
                                                                        2,
                                                                        3,
                                                                        0,
                                                                        0,
                                                                        kHidText,
                                                                        9,
                                                                        kHid,
                                                                        0x11,
                                                                        0x01,
                                                                        0,
                                                                        1,
                                                                        kReport,
                                                                        low(kHidReport.size()),
                                                                        high(kHidReport.size()),
                                                                        7,
                                                                        5,
                                                                        kHidIn,
                                                                        3,
                                                                        64,
                                                                        0,
                                                                        1,
                                                                        7,
                                                                        5,
                                                                        kHidOut,
                                                                        3,
                                                                        64,
                                                                        0,
                                                                        1,
                                                                        9,
                                                                        4,
                                                                        kBulkInterface,
                                                                        0,
                                                                        2,
                                                                        0xFF,
                                                                        0,
                                                                        0,
                                                                        kBulkText,
                                                                        7,
                                                                        5,
                                                                        kBulkIn,
                                                                        2,
                                                                        64,
                                                                        0,
                                                                        0,
                                                                        7,
                                                                        5,
                                                                        kBulkOut,
                                                                        2,
                                                                        64,
                                                                        0,
                                                                        0,
                                                                        9,
                                                                        4,
                                                                        kDfuInterface,
                                                                        0,
                                                                        0,
                                                                        0xFE,
                                                                        1,
                                                                        1,
                                                                        kDfuText,
                                                                        9,
                                                                        0x21,
                                                                        kDfuAttributes | kWillDetach,
                                                                        low(kDetachTimeout_ms),
                                                                        high(kDetachTimeout_ms),
                                                                        low(kDfuBlockBytes),
                                                                        high(kDfuBlockBytes),
                                                                        0x10,
                                                                        0x01};
constexpr std::size_t kHidDescriptorAt = 9 + 9;

constexpr std::size_t kDfuBytes = 9 + 9 + 9;
constexpr std::array<std::uint8_t, kDfuBytes> kDfuConfiguration{9,
                                                                kConfiguration,
                                                                low(kDfuBytes),
                                                                high(kDfuBytes),
                                                                1,
                                                                1,
                                                                0,
                                                                0xC0,
                                                                0,
                                                                9,
                                                                4,
                                                                0,
                                                                0,
                                                                0,
                                                                0xFE,
                                                                1,
                                                                2,
                                                                kPackageText,
                                                                9,
                                                                0x21,
                                                                kDfuAttributes,
                                                                low(kDetachTimeout_ms),
                                                                high(kDetachTimeout_ms),
                                                                low(kDfuBlockBytes),
                                                                high(kDfuBlockBytes),
                                                                0x10,
                                                                0x01};

// The set follows Microsoft OS 2.0. Without it Windows would ask for a driver for the bulk and DFU interfaces; HID
// needs none.
constexpr std::size_t kHeaderBytes = 10, kSubsetBytes = 8, kCompatibleBytes = 20;
constexpr std::u16string_view kGuidName = u"DeviceInterfaceGUIDs";
constexpr std::u16string_view kGuid = u"{6D0A3C1E-53B4-4E1B-9C02-7A5D2F8E4B11}";
constexpr std::size_t kNameBytes = 2 * (kGuidName.size() + 1),
                      kGuidBytes = 2 * (kGuid.size() + 2);  // A REG_MULTI_SZ ends with two zeros.
constexpr std::size_t kPropertyBytes = 10 + kNameBytes + kGuidBytes;
constexpr std::size_t kFunctionBytes = kSubsetBytes + kCompatibleBytes + kPropertyBytes;
constexpr std::size_t kRunTimeSetBytes = kHeaderBytes + kSubsetBytes + 2 * kFunctionBytes;
constexpr std::size_t kDfuSetBytes = kHeaderBytes + kCompatibleBytes + kPropertyBytes;

constexpr void put_text(ByteWriter& w, std::u16string_view text, std::size_t zeros) {
  for (const char16_t c : text) w.le16(c);
  for (std::size_t k = 0; k < zeros; ++k) w.le16(0);
}

constexpr void put_header(ByteWriter& w, std::size_t total) {
  w.le16(kHeaderBytes);
  w.le16(0);           // This is the size of the set's header.
  w.le32(0x06030000);  // The set is for Windows 8.1 and later.
  w.le16(static_cast<std::uint16_t>(total));
}

constexpr void put_winusb(ByteWriter& w) {
  w.le16(kCompatibleBytes);
  w.le16(3);
  for (const char c : std::string_view("WINUSB")) w.u8(static_cast<std::uint8_t>(c));
  for (int k = 0; k < 10; ++k) w.u8(0);
  w.le16(kPropertyBytes);
  w.le16(4);
  w.le16(7);  // The type 7 is REG_MULTI_SZ.
  w.le16(kNameBytes);
  put_text(w, kGuidName, 1);
  w.le16(kGuidBytes);
  put_text(w, kGuid, 2);
}

constexpr void put_function(ByteWriter& w, std::uint8_t interface) {
  w.le16(kSubsetBytes);
  w.le16(2);
  w.u8(interface);
  w.u8(0);
  w.le16(kFunctionBytes);
  put_winusb(w);
}

constexpr std::array<std::uint8_t, kRunTimeSetBytes> kRunTimeSet = [] {
  std::array<std::uint8_t, kRunTimeSetBytes> bytes{};
  ByteWriter w(bytes);
  put_header(w, kRunTimeSetBytes);
  w.le16(kSubsetBytes);
  w.le16(1);
  w.u8(0);  // The number is the index of the configuration.
  w.u8(0);
  w.le16(kRunTimeSetBytes - kHeaderBytes);
  put_function(w, kBulkInterface);
  put_function(w, kDfuInterface);
  return bytes;
}();

constexpr std::array<std::uint8_t, kDfuSetBytes> kDfuSet = [] {  // One interface needs no subsets.
  std::array<std::uint8_t, kDfuSetBytes> bytes{};
  ByteWriter w(bytes);
  put_header(w, kDfuSetBytes);
  put_winusb(w);
  return bytes;
}();

constexpr std::size_t kBosBytes = 5 + 28;
constexpr std::array<std::uint8_t, kBosBytes> make_bos(std::size_t set_bytes) {
  return {5,
          kBos,
          kBosBytes,
          0,
          1,
          28,
          0x10,
          5,
          0,  // The platform capability is Microsoft OS 2.0.
          0xDF,
          0x60,
          0xDD,
          0xD8,
          0x89,
          0x45,
          0xC7,
          0x4C,
          0x9C,
          0xD2,
          0x65,
          0x9D,
          0x9E,
          0x64,
          0x8A,
          0x9F,
          0x00,
          0x00,
          0x03,
          0x06,
          low(set_bytes),
          high(set_bytes),
          kMicrosoftCode,
          0};
}
constexpr auto kRunTimeBos = make_bos(kRunTimeSetBytes), kDfuBos = make_bos(kDfuSetBytes);

std::string_view text_of(std::uint8_t index) {
  switch (index) {
    case kVendorText:
      return "Triskin";
    case kProductText:
      return "Triskin patch controller";
    case kHidText:
      return "Triskin requests (HID)";
    case kBulkText:
      return "Triskin requests and stream";
    case kDfuText:
      return "Triskin firmware update";
    case kPackageText:
      return "Triskin firmware package";
    default:
      return {};
  }
}

}  // namespace

Bytes device_descriptor(bool dfu_mode) {
  return dfu_mode ? Bytes(kDfuDevice) : Bytes(kRunTimeDevice);
}
Bytes configuration_descriptor(bool dfu_mode) {
  return dfu_mode ? Bytes(kDfuConfiguration) : Bytes(kRunTimeConfiguration);
}
Bytes hid_descriptor() {
  return Bytes(kRunTimeConfiguration).subspan(kHidDescriptorAt, 9);
}
Bytes hid_report_descriptor() {
  return kHidReport;
}
Bytes bos_descriptor(bool dfu_mode) {
  return dfu_mode ? Bytes(kDfuBos) : Bytes(kRunTimeBos);
}
Bytes microsoft_set(bool dfu_mode) {
  return dfu_mode ? Bytes(kDfuSet) : Bytes(kRunTimeSet);
}

Bytes string_descriptor(std::uint8_t index, const wire::UniqueId& unique_id, std::span<std::uint8_t> out) {
  ByteWriter w(out);
  w.u8(0);
  w.u8(kString);
  if (index == 0) {
    w.le16(0x0409);  // The strings are in English.
  } else if (index == kSerial) {
    for (const std::uint8_t b : unique_id) {
      for (const int digit : {b >> 4, b & 0xF})
        w.le16(static_cast<std::uint16_t>(digit < 10 ? '0' + digit : 'A' + digit - 10));
    }
  } else {
    for (const char c : text_of(index)) w.le16(static_cast<std::uint16_t>(c));
    if (w.size() == 2) return {};
  }
  if (!w.ok()) return {};
  out[0] = static_cast<std::uint8_t>(w.size());
  return w.written();
}

}  // namespace triskin::fw::usb
