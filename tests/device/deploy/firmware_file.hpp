// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "support/package_bytes.hpp"
#include "triskin/deploy/firmware_update.hpp"
#include "triskin/hardware/virtual_skin.hpp"

namespace triskin::test {

inline deploy::FirmwarePackage make_firmware(const FirmwareFile& file) {
  deploy::FirmwarePackage p;
  p.bytes = package_bytes(file);
  p.head = layout::decode_package_head(p.bytes).value();
  return p;
}

/// Whatever its slots held before, the controller of `patch` then runs the package's image from `slot`, confirmed, as
/// if it had done so for long.
inline void install(hardware::VirtualSkin& skin, std::size_t patch, int slot, const deploy::FirmwarePackage& package) {
  constexpr std::size_t kSlot = sim::kSlotsBytes / 2, kPage = 2048;
  hardware::FlashMemory& flash = skin.slots(patch);
  const Bytes image = package.image(slot);
  const std::size_t origin = static_cast<std::size_t>(slot) * kSlot, records = origin + kSlot - kPage;
  for (std::size_t at = 0; at < sim::kSlotsBytes; at += kPage) (void)flash.erase_page(at);
  (void)flash.program(origin, image);
  (void)flash.program(records, commit_record(image));
  // The first of the confirmations, behind three places for starts (firmware/boot, SlotStore).
  (void)flash.program(records + 1024 + 3 * 8, std::array<std::uint8_t, 8>{'T', 'S', 'K', 'M', 'A', 'R', 'K', 0});
  skin.power_cycle(patch);
}

}  // namespace triskin::test
