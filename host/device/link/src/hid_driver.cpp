// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <hidapi.h>

#include <algorithm>
#include <array>

#include "triskin/base/error.hpp"
#include "triskin/link/usb_link.hpp"

namespace triskin::link {
namespace {

// Serial numbers are hexadecimal digits, so each character fits into one byte.
std::string narrow(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != L'\0'; ++text) out += *text < 128 ? static_cast<char>(*text) : '?';
  return out;
}

class HidPipe final : public UsbPipe {
 public:
  HidPipe(hid_device* device, std::string serial, std::string place)
      : device_(device), serial_(std::move(serial)), place_(std::move(place)) {}
  ~HidPipe() override { ::hid_close(device_); }
  HidPipe(const HidPipe&) = delete;
  HidPipe& operator=(const HidPipe&) = delete;

  void write(const wire::UsbPacket& packet) override {
    // The first byte is the report id, which is not used.
    std::array<std::uint8_t, wire::kUsbPacketBytes + 1> report{};
    std::copy(packet.bytes.begin(), packet.bytes.end(), report.begin() + 1);
    if (::hid_write(device_, report.data(), report.size()) < 0)
      throw DeviceError("hid: " + serial_ + " cannot be written: unplugged");
  }
  std::size_t read(std::span<std::uint8_t> packet, int timeout_ms) override {
    const int n = ::hid_read_timeout(device_, packet.data(), packet.size(), timeout_ms);
    if (n < 0) throw DeviceError("hid: " + serial_ + " cannot be read: unplugged");
    return static_cast<std::size_t>(n);
  }
  [[nodiscard]] std::string serial() const override { return serial_; }
  [[nodiscard]] std::string place() const override { return place_; }

 private:
  hid_device* device_;
  std::string serial_, place_;
};

class HidDriver final : public UsbDriver {
 public:
  HidDriver() {
    if (::hid_init() != 0) throw DeviceError("hid: hidapi cannot be started");
  }
  ~HidDriver() override { ::hid_exit(); }
  HidDriver(const HidDriver&) = delete;
  HidDriver& operator=(const HidDriver&) = delete;

  std::vector<std::unique_ptr<UsbPipe>> open(const std::string& serial,
                                             const std::vector<std::string>& places) override {
    std::vector<std::unique_ptr<UsbPipe>> pipes;
    std::string refused;
    hid_device_info* const list = ::hid_enumerate(wire::kUsbVendor, wire::kUsbProduct);
    for (const hid_device_info* d = list; d != nullptr; d = d->next) {
      const std::string number = narrow(d->serial_number), place = d->path;
      if ((!serial.empty() && number != serial) || std::ranges::find(places, place) != places.end()) continue;
      if (hid_device* const device = ::hid_open_path(d->path))
        pipes.push_back(std::make_unique<HidPipe>(device, number, place));
      else
        refused = place;
    }
    ::hid_free_enumeration(list);
    if (pipes.empty() && places.empty() && !refused.empty()) {
      throw DeviceError(fmt::format("hid: {} may not be opened; run: triskin doctor", refused));
    }
    return pipes;
  }
  [[nodiscard]] std::string name() const override { return "hid"; }
};

}  // namespace

std::unique_ptr<UsbDriver> make_hid_driver() {
  return std::make_unique<HidDriver>();
}

}  // namespace triskin::link
