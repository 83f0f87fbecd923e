// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/boot/slot_store.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/logic/usb/usb_control.hpp"

namespace triskin::boot {

/// In DFU mode (DFU 1.1, manifestation tolerant) the controller accepts a firmware package and stores the image for the
/// slot that is not in use. A package that ends early or is damaged is refused; the slot in use is never touched.
class DfuDevice final : public wire::UsbFunction {
 public:
  /// After this much silence it returns to the application; dfu-util waits 5 s before its first request.
  static constexpr std::uint64_t kPatience_us = 15'000'000, kAfterCommit_us = 3'000'000;

  /// `slots` must outlive the device; `unique_id` becomes the serial number. With `leaves`, silence makes it return to
  /// an application; if none can start, it stays.
  DfuDevice(SlotStore& slots, const wire::UniqueId& unique_id, bool leaves = true)
      : slots_(slots), control_(unique_id, true), leaves_(leaves) {}

  void reset() override { control_.reset(); }
  std::optional<Bytes> control(const wire::UsbSetup& setup, Bytes out) override;
  void out(std::uint8_t, Bytes) override {}
  Bytes in(std::uint8_t) override { return {}; }
  [[nodiscard]] bool wants_to_reconnect() const override { return leave_; }

  /// Advances the time. A device that was asked to leave, or that heard nothing from a host, wants to reconnect.
  void tick(std::uint64_t now_us);
  /// Returns the time at which tick() has work, in µs of the port's clock; UINT64_MAX means never.
  [[nodiscard]] std::uint64_t next_event_us() const {
    return leave_ || stays() ? UINT64_MAX : last_us_ + patience_us();
  }
  /// Returns true if a complete image was stored since the last download began.
  [[nodiscard]] bool committed() const { return committed_; }

 private:
  enum class State : std::uint8_t { kIdle = 2, kDownloadSync = 3, kDownloadIdle = 5, kManifestSync = 6, kError = 10 };
  enum class Error : std::uint8_t {
    kNone = 0,
    kTarget = 1,
    kFile = 2,
    kWrite = 3,
    kErase = 4,
    kNotDone = 9,
    kFirmware = 10,
    kStalled = 15
  };

  [[nodiscard]] bool stays() const { return !leaves_ && !committed_; }
  [[nodiscard]] std::uint64_t patience_us() const { return committed_ ? kAfterCommit_us : kPatience_us; }
  std::optional<Bytes> download(const wire::UsbSetup& setup, Bytes data);
  std::optional<Bytes> fail(Error error);
  Error take(Bytes data);
  Error erase_up_to(std::size_t end);
  Error begin(Bytes head);
  Error manifest();
  Bytes status();

  SlotStore& slots_;
  fw::UsbControl control_;
  State state_ = State::kIdle;
  Error error_ = Error::kNone;
  layout::PackageHead head_;
  int slot_ = -1;
  std::uint32_t at_ = 0;  // This many bytes of the package were received so far.
  std::array<std::uint8_t, 6> reply_{};
  std::uint64_t last_us_ = 0;
  std::size_t erased_pages_ = 0;  // Only pages of the image's slot count, without those of the records.
  bool leaves_;
  bool heard_ = true, leave_ = false, committed_ = false;
};

}  // namespace triskin::boot
