// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "triskin/link/link.hpp"
#include "triskin/link/node_map.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::device {

/// A pipe to one USB device. Threads: one may read while another writes. Calls throw DeviceError when the device is
/// gone.
class UsbPipe {
 public:
  virtual ~UsbPipe() = default;
  /// Sends one packet; waits until the device has taken it.
  virtual void write(const wire::UsbPacket& packet) = 0;
  /// Reads whole packets one after another, each wire::kUsbPacketBytes long but the last; waits up to `timeout_ms` for
  /// the first. Returns the number of bytes; 0: nothing arrived.
  virtual std::size_t read(std::span<std::uint8_t> packets, int timeout_ms) = 0;
  /// Serial number: the unique id of the controller, 24 hexadecimal digits.
  [[nodiscard]] virtual std::string serial() const = 0;
  /// Path of the port; pipes with equal places lead to one device.
  [[nodiscard]] virtual std::string place() const = 0;
};

/// Finds and opens devices: HID (hidapi) or the vendor interface (libusb).
class UsbDriver {
 public:
  virtual ~UsbDriver() = default;
  /// Opens all devices that are plugged in and not at one of `places`; `serial` selects one of them, empty: all. Throws
  /// DeviceError with the remedy when devices are there and none could be opened.
  virtual std::vector<std::unique_ptr<UsbPipe>> open(const std::string& serial,
                                                     const std::vector<std::string>& places) = 0;
  /// True: a hot-plug event has arrived since the last call; false also where the system reports none. Cheap.
  [[nodiscard]] virtual bool changed() { return false; }
  /// "hid" or "usb", as `--link` has it.
  [[nodiscard]] virtual std::string name() const = 0;
};
/// Driver of the HID interface. Throws DeviceError when hidapi cannot be started.
[[nodiscard]] std::unique_ptr<UsbDriver> make_hid_driver();
/// Driver of the vendor interface. Throws DeviceError when libusb finds no USB on this computer.
[[nodiscard]] std::unique_ptr<UsbDriver> make_bulk_driver();

/// All Triskin controllers on this computer's USB, or the one with a serial number, as one bus. A request goes to the
/// device that has answered from its node address, everything else to every device, as on CAN. Devices may come and go;
/// the link is dead when the last one has gone, until reconnect() finds one.
class UsbLink final : public Link {
 public:
  /// Opens all devices of `driver`, or the one with serial number `serial` (24 hexadecimal digits; empty: all). Throws
  /// DeviceError when none is there.
  UsbLink(std::unique_ptr<UsbDriver> driver, const std::string& serial);
  ~UsbLink() override;
  UsbLink(const UsbLink&) = delete;
  UsbLink& operator=(const UsbLink&) = delete;

  void send(const wire::CanFrame& frame) override;
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override;
  [[nodiscard]] std::uint64_t now_us() const override;
  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint8_t frame_bytes() const override { return wire::kUsbFrameBytes; }
  [[nodiscard]] std::uint64_t answer_us() const override { return 1'000'000; }
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string trouble() const override;
  [[nodiscard]] int wire_of(std::uint8_t node) const override;
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t) const override {
    return driver_->name() == "hid" ? wire::kUsbHidFrame_ns : wire::kUsbBulkFrame_ns;
  }
  void reconnect() override;

 private:
  struct Device {
    int wire = 0;
    std::unique_ptr<UsbPipe> pipe;
    std::jthread reader;
    bool gone = false;
  };
  static constexpr std::chrono::milliseconds kScanEvery{2000};  // Scan period if the driver reports no hot-plug events.
  static constexpr std::chrono::milliseconds kSlice{50};        // Time between two calls of UsbDriver::changed.

  void open_new_devices();
  void read_all(Device& device, const std::stop_token& stop);
  void remove_gone();
  [[nodiscard]] std::optional<wire::CanFrame> next_frame(std::uint64_t until_us);
  [[noreturn]] void fail(const std::string& what) const;

  std::unique_ptr<UsbDriver> driver_;
  std::string serial_, name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_scan_ = start_;
  mutable std::mutex mutex_;  // Guards frames_, gone, lost_ and nodes_.
  std::condition_variable came_;
  std::deque<wire::CanFrame> frames_;
  std::vector<std::string> lost_;  // Serial numbers of devices that went away.
  NodeMap nodes_;
  int wires_ = 0;
  std::vector<std::unique_ptr<Device>> devices_;  // Declared last because its threads use the members above.
};

}  // namespace triskin::device
