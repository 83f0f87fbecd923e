// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <atomic>

#include "triskin/base/error.hpp"
#include "triskin/link/usb_link.hpp"

namespace triskin::link {
namespace {

class BulkPipe final : public UsbPipe {
 public:
  BulkPipe(libusb_device_handle* handle, std::string serial, std::string place)
      : handle_(handle), serial_(std::move(serial)), place_(std::move(place)) {}
  ~BulkPipe() override {
    (void)::libusb_release_interface(handle_, wire::kBulkInterface);
    ::libusb_close(handle_);
  }
  BulkPipe(const BulkPipe&) = delete;
  BulkPipe& operator=(const BulkPipe&) = delete;

  void write(const wire::UsbPacket& packet) override {
    constexpr unsigned kTimeout_ms = 1000;
    auto bytes = packet.bytes;
    int written = 0;
    const int error = ::libusb_bulk_transfer(handle_, wire::kBulkOut, bytes.data(), static_cast<int>(packet.size),
                                             &written, kTimeout_ms);
    if (error != 0)
      throw DeviceError(fmt::format("usb: {} cannot be written: {}", serial_, ::libusb_error_name(error)));
  }
  std::size_t read(std::span<std::uint8_t> packet, int timeout_ms) override {
    int got = 0;
    const int error = ::libusb_bulk_transfer(handle_, wire::kBulkIn, packet.data(), static_cast<int>(packet.size()),
                                             &got, static_cast<unsigned>(timeout_ms));
    if (error != 0 && error != LIBUSB_ERROR_TIMEOUT) {
      throw DeviceError(fmt::format("usb: {} cannot be read: {}", serial_, ::libusb_error_name(error)));
    }
    return static_cast<std::size_t>(got);
  }
  [[nodiscard]] std::string serial() const override { return serial_; }
  [[nodiscard]] std::string place() const override { return place_; }

 private:
  libusb_device_handle* handle_;
  std::string serial_, place_;
};

// Also reads the descriptor.
bool is_controller(libusb_device* device, libusb_device_descriptor& d) {
  return ::libusb_get_device_descriptor(device, &d) == 0 && d.idVendor == wire::kUsbVendor &&
         d.idProduct == wire::kUsbProduct;
}

std::string place_of(libusb_device* device) {
  return fmt::format("{}-{}", ::libusb_get_bus_number(device), ::libusb_get_device_address(device));
}

class BulkDriver final : public UsbDriver {
 public:
  BulkDriver() {
    if (const int error = ::libusb_init(&context_); error != 0) {
      throw DeviceError(fmt::format("usb: this computer has no USB ({})", ::libusb_error_name(error)));
    }
    constexpr int kEvents = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
    // Without hot-plug events the link searches for devices itself.
    if (::libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return;
    (void)::libusb_hotplug_register_callback(context_, kEvents, 0, wire::kUsbVendor, wire::kUsbProduct,
                                             LIBUSB_HOTPLUG_MATCH_ANY, note_change, this, nullptr);
  }
  ~BulkDriver() override { ::libusb_exit(context_); }  // libusb_exit() also removes the hot-plug callback.
  BulkDriver(const BulkDriver&) = delete;
  BulkDriver& operator=(const BulkDriver&) = delete;

  std::vector<std::unique_ptr<UsbPipe>> open(const std::string& serial,
                                             const std::vector<std::string>& places) override {
    std::vector<std::unique_ptr<UsbPipe>> pipes;
    std::string refused;
    libusb_device** list = nullptr;
    const ssize_t count = ::libusb_get_device_list(context_, &list);
    for (ssize_t k = 0; k < count; ++k) {
      libusb_device_descriptor d{};
      if (!is_controller(list[k], d)) continue;
      const std::string place = place_of(list[k]);
      if (std::ranges::find(places, place) != places.end()) continue;
      if (auto pipe = open_one(list[k], d, serial, place, refused)) pipes.push_back(std::move(pipe));
    }
    if (list != nullptr) ::libusb_free_device_list(list, 1);
    if (pipes.empty() && places.empty() && !refused.empty()) throw DeviceError("usb: " + refused);
    return pipes;
  }
  [[nodiscard]] bool changed() override {
    timeval no_time{};
    (void)::libusb_handle_events_timeout_completed(context_, &no_time, nullptr);
    return changed_.exchange(false);
  }
  [[nodiscard]] std::string name() const override { return "usb"; }

 private:
  // libusb calls this in whichever thread handles its events.
  static int LIBUSB_CALL note_change(libusb_context*, libusb_device*, libusb_hotplug_event, void* driver) {
    static_cast<BulkDriver*>(driver)->changed_ = true;
    return 0;
  }
  static std::unique_ptr<UsbPipe> open_one(libusb_device* device, const libusb_device_descriptor& d,
                                           const std::string& serial, const std::string& place, std::string& refused) {
    libusb_device_handle* handle = nullptr;
    if (const int error = ::libusb_open(device, &handle); error != 0) {
      refused = fmt::format("the controller at {} may not be opened ({}); run: triskin doctor", place,
                            ::libusb_error_name(error));
      return nullptr;
    }
    std::array<unsigned char, 64> text{};
    const int n =
        ::libusb_get_string_descriptor_ascii(handle, d.iSerialNumber, text.data(), static_cast<int>(text.size()));
    const std::string number(text.begin(), text.begin() + std::max(n, 0));
    const bool wanted = serial.empty() || number == serial;
    if (const int error = wanted ? ::libusb_claim_interface(handle, wire::kBulkInterface) : LIBUSB_ERROR_NOT_FOUND;
        error != 0) {
      if (wanted)
        refused = fmt::format("controller {} is used by another program ({})", number, ::libusb_error_name(error));
      ::libusb_close(handle);
      return nullptr;
    }
    return std::make_unique<BulkPipe>(handle, number, place);
  }

  libusb_context* context_ = nullptr;
  std::atomic<bool> changed_ = false;
};

}  // namespace

std::unique_ptr<UsbDriver> make_bulk_driver() {
  return std::make_unique<BulkDriver>();
}

}  // namespace triskin::link
