// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "triskin/link/link.hpp"
#include "triskin/link/node_map.hpp"
#include "triskin/wire/bus_load.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::link {

/// A pipe leads to one USB device. One thread may read while another writes. Calls throw DeviceError when the device is
/// unplugged.
class UsbPipe {
 public:
  virtual ~UsbPipe() = default;
  /// Sends one packet; waits until the device has accepted it.
  virtual void write(const wire::UsbPacket& packet) = 0;
  /// Reads whole packets one after another, each wire::kUsbPacketBytes long except the last; waits up to `timeout_ms`
  /// for the first. Returns the number of bytes; 0 means that nothing arrived.
  virtual std::size_t read(std::span<std::uint8_t> packets, int timeout_ms) = 0;
  /// Returns the serial number: the unique id of the controller, 24 hexadecimal digits.
  [[nodiscard]] virtual std::string serial() const = 0;
  /// Returns the path of the port; pipes with equal paths lead to the same device.
  [[nodiscard]] virtual std::string place() const = 0;
};

/// Finds and opens devices by HID (hidapi) or the vendor interface (libusb).
class UsbDriver {
 public:
  virtual ~UsbDriver() = default;
  /// Opens all plugged-in devices that are not at one of `places`; `serial` selects one of them, and an empty text all.
  /// Throws DeviceError with the remedy when there are devices but none could be opened.
  virtual std::vector<std::unique_ptr<UsbPipe>> open(const std::string& serial,
                                                     const std::vector<std::string>& places) = 0;
  /// Returns true if a hot-plug event has arrived since the last call; always false where the system reports none. The
  /// call is cheap.
  [[nodiscard]] virtual bool changed() { return false; }
  /// Returns "hid" or "usb", in the syntax of `--link`.
  [[nodiscard]] virtual std::string name() const = 0;
};
/// Makes the driver of the HID interface. Throws DeviceError when hidapi cannot be started.
[[nodiscard]] std::unique_ptr<UsbDriver> make_hid_driver();
/// Makes the driver of the vendor interface. Throws DeviceError when libusb finds no USB on this computer.
[[nodiscard]] std::unique_ptr<UsbDriver> make_bulk_driver();

/// The link joins all Triskin controllers on this computer's USB, or has the one with a given serial number, as one
/// bus. A request goes to the device that has answered from its node address; all other frames go to every device, as
/// on CAN. Devices may be plugged and unplugged; after the last one is unplugged, the link is dead until reconnect()
/// finds one.
class UsbLink final : public Link {
 public:
  /// Opens all devices of `driver`, or the one with serial number `serial` (24 hexadecimal digits; empty: all). Throws
  /// DeviceError when there is none.
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
  // If the driver reports no hot-plug events, devices are searched this often.
  static constexpr std::chrono::milliseconds kScanEvery{2000};
  static constexpr std::chrono::milliseconds kSlice{50};  // UsbDriver::changed is called this often.

  [[nodiscard]] std::vector<std::unique_ptr<UsbPipe>> new_pipes();
  void open_new_devices();
  void read_all(Device& device, const std::stop_token& stop);
  void remove_gone();
  [[nodiscard]] std::optional<wire::CanFrame> next_frame(std::uint64_t until_us);
  [[noreturn]] void fail(const std::string& what) const;

  std::unique_ptr<UsbDriver> driver_;
  std::string serial_, name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_scan_ = start_;
  mutable std::mutex mutex_;  // The mutex guards frames_, gone, lost_ and nodes_.
  std::condition_variable came_;
  std::deque<wire::CanFrame> frames_;
  std::set<std::string> lost_;  // The serial numbers belong to devices that were unplugged.
  NodeMap nodes_;
  int wires_ = 0;
  // The devices are declared last, because their threads use the members above.
  std::vector<std::unique_ptr<Device>> devices_;
};

}  // namespace triskin::link
