// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/logic/usb/usb_control.hpp"
#include "triskin/ports/ports.hpp"
#include "triskin/wire/unique_id.hpp"
#include "triskin/wire/usb_packet.hpp"

namespace triskin::fw {

/// As a USB device, the controller has two sides. To the host it is HID, vendor bulk and DFU run time
/// (docs/protocol.md, "USB"); to the application it is another port for frames. Frames leave by the interface that the
/// host used last.
class UsbDevice final : public wire::UsbFunction, public CanPort {
 public:
  explicit UsbDevice(const wire::UniqueId& unique_id) : control_(unique_id, false) {}

  void reset() override;
  std::optional<Bytes> control(const wire::UsbSetup& setup, Bytes out) override;
  void out(std::uint8_t endpoint, Bytes packet) override;
  Bytes in(std::uint8_t endpoint) override;
  /// Returns true if the host has asked for DFU mode.
  [[nodiscard]] bool wants_to_reconnect() const override { return detach_; }

  [[nodiscard]] bool fd() const override { return true; }
  [[nodiscard]] std::uint8_t frame_bytes() const override { return wire::kUsbFrameBytes; }
  bool send(const wire::CanFrame& frame) override;
  [[nodiscard]] bool has_room() const override { return !waiting_.full() || !control_.configured() || endpoint_ == 0; }
  std::optional<wire::CanFrame> receive() override;
  /// Returns true when a frame of the host waits to be received.
  [[nodiscard]] bool frame_waits() const { return received_.count != 0; }

 private:
  template <typename T, std::size_t N>
  struct Queue {
    std::array<T, N> items{};
    std::size_t first = 0, count = 0;
    [[nodiscard]] bool full() const { return count == N; }
    void push(const T& item) { items[(first + count++) % N] = item; }
    T pop() {
      const T item = items[first];
      first = (first + 1) % N;
      --count;
      return item;
    }
  };

  UsbControl control_;
  Queue<wire::CanFrame, 32> received_;
  Queue<wire::UsbPacket, 32> waiting_;
  wire::UsbPacket leaving_;
  std::uint8_t endpoint_ = 0;  // The host's last packet came to this endpoint; 0 means that there was none.
  std::uint8_t idle_ = 0;
  bool detach_ = false;
};

}  // namespace triskin::fw
