// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "triskin/wire/unique_id.hpp"
#include "triskin/wire/usb_function.hpp"

namespace triskin::fw {

/// The standard requests (USB 2.0 §9.4), descriptors and the Microsoft request are the same for run time and DFU mode.
class UsbControl {
 public:
  UsbControl(const wire::UniqueId& unique_id, bool dfu_mode) : unique_id_(unique_id), dfu_mode_(dfu_mode) {}
  /// Handles a bus reset: address 0, not configured.
  void reset() { configuration_ = 0; }
  /// Returns true once the host has chosen the configuration.
  [[nodiscard]] bool configured() const { return configuration_ != 0; }
  /// Does the same as UsbFunction::control, but stalls class requests, which it does not know.
  std::optional<Bytes> handle(const wire::UsbSetup& setup);

 private:
  std::optional<Bytes> descriptor(const wire::UsbSetup& setup);
  [[nodiscard]] std::uint16_t interfaces() const { return dfu_mode_ ? 1 : 3; }

  wire::UniqueId unique_id_;
  bool dfu_mode_;
  std::uint8_t configuration_ = 0;
  std::array<std::uint8_t, 64> reply_{};
};

}  // namespace triskin::fw
