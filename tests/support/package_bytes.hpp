// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/layout/image_label.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::test {

/// Makes two images whose vectors fit their slots.
struct FirmwareFile {
  std::uint32_t size_bytes = 1024;  ///< Both images have this size.
  std::uint8_t fill = 0;
  bool labelled = true;
  std::uint32_t version = 0x00020000;
  std::array<std::uint8_t, 8> hardware = wire::kPartNumber;
};

inline constexpr std::array<std::uint32_t, 2> kSlotOrigins{0x08004000, 0x08040000};

/// Returns the record that makes `image` the first one committed in its slot (firmware/boot, SlotStore).
inline std::array<std::uint8_t, 16> commit_record(Bytes image) {
  std::array<std::uint8_t, 16> record{};
  ByteWriter w(record);
  w.le32(layout::kCommitMagic);
  w.le32(1);
  w.le32(static_cast<std::uint32_t>(image.size()));
  w.le32(layout::slot_crc(1, image));
  return record;
}

inline std::vector<std::uint8_t> package_bytes(const FirmwareFile& file) {
  std::vector<std::uint8_t> bytes(layout::kPackageHeadBytes + std::size_t{2} * file.size_bytes);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(file.fill + k % 7);
  const auto put = [&](std::size_t at, std::uint32_t v) {
    for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::uint8_t>(v >> (8 * k));
  };
  for (std::size_t slot = 0; slot < 2; ++slot) {
    const std::size_t at = layout::kPackageHeadBytes + slot * file.size_bytes;
    put(at, 0x20010000);
    put(at + 4, kSlotOrigins[slot] + 0x201);
    if (file.labelled)
      std::ranges::copy(layout::encode_label({file.hardware, file.version, kSlotOrigins[slot]}),
                        bytes.begin() + static_cast<std::ptrdiff_t>(at + layout::kLabelOffset));
    put(12 + 4 * slot, file.size_bytes);
    put(20 + 4 * slot, crc32(Bytes(bytes).subspan(at, file.size_bytes)));
  }
  std::ranges::copy(layout::kPackageMagic, bytes.begin());
  bytes[4] = 1;
  bytes[5] = 0;
  bytes[6] = layout::kPackageHeadBytes;
  bytes[7] = 0;
  put(8, file.version);
  put(28, crc32(Bytes(bytes).first(28)));
  return bytes;
}

}  // namespace triskin::test
