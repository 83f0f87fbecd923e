// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "triskin/deploy/firmware_update.hpp"
#include "triskin/layout/image_label.hpp"
#include "triskin/link/link.hpp"
#include "triskin/machine/flash_chip.hpp"
#include "triskin/wire/can_frame.hpp"

namespace triskin::machine {

/// Presents the bus of a bench as a link of the host; its time is that of the machine.
class MachineLink final : public link::Link {
 public:
  struct Ends {
    std::function<void(const wire::CanFrame&)> send;
    std::function<void(std::uint64_t us)> run_for;
    std::function<std::uint64_t()> now_us;
    const std::vector<wire::CanFrame>* frames;  ///< All received frames are kept in order.
    std::function<std::size_t()> waiting;       ///< Returns how many sent frames wait for the bus.
  };
  MachineLink(Ends ends, bool fd) : ends_(std::move(ends)), fd_(fd), seen_(ends_.frames->size()) {}

  // Waits as long as the queue of a CAN adapter would be full.
  void send(const wire::CanFrame& frame) override {
    while (ends_.waiting() >= kQueue) ends_.run_for(kSlice_us);
    ends_.send(frame);
  }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override {
    while (true) {
      if (seen_ > ends_.frames->size()) seen_ = 0;  // The test has cleared the list.
      if (seen_ < ends_.frames->size()) return (*ends_.frames)[seen_++];
      const std::uint64_t now = now_us();
      if (now >= until_us) return std::nullopt;
      ends_.run_for(std::min(kSlice_us, until_us - now));
    }
  }
  [[nodiscard]] std::uint64_t now_us() const override { return ends_.now_us(); }
  [[nodiscard]] bool fd() const override { return fd_; }
  [[nodiscard]] std::uint64_t answer_us() const override { return 100'000; }
  [[nodiscard]] std::string name() const override { return "machine"; }

 private:
  static constexpr std::size_t kQueue = 10;
  static constexpr std::uint64_t kSlice_us = 200;
  Ends ends_;
  bool fd_;
  std::size_t seen_;
};

/// Makes a firmware file of the application from the two images, with the version in their labels.
inline deploy::FirmwarePackage package_of(const ElfImage& a, const ElfImage& b) {
  deploy::FirmwarePackage p;
  p.bytes.resize(layout::kPackageHeadBytes);
  p.head.firmware_version = layout::decode_label(a.flat()).value().firmware_version;
  for (std::size_t slot = 0; slot < 2; ++slot) {
    std::vector<std::uint8_t> image = (slot == 0 ? a : b).flat();
    image.resize((image.size() + 7) / 8 * 8, 0xFF);
    p.head.size_bytes[slot] = static_cast<std::uint32_t>(image.size());
    p.head.crc[slot] = crc32(image);
    p.bytes.insert(p.bytes.end(), image.begin(), image.end());
  }
  return p;
}

}  // namespace triskin::machine
