// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "support/package_bytes.hpp"
#include "triskin/core/bytes.hpp"
#include "triskin/layout/image_label.hpp"
#include "triskin/wire/identity.hpp"

namespace triskin::test {

/// Makes an image with vectors and label that fit the slot.
inline std::vector<std::uint8_t> image_for(int slot, std::uint32_t version, std::size_t bytes, std::uint8_t fill) {
  std::vector<std::uint8_t> image(bytes);
  for (std::size_t k = 0; k < bytes; ++k) image[k] = static_cast<std::uint8_t>(fill + k / 8 + k % 8);
  std::fill_n(image.begin() + 512, 64, std::uint8_t{0xFF});  // This gap reads as erased.
  ByteWriter w(image);
  w.le32(0x20010000);
  w.le32(kSlotOrigins[static_cast<std::size_t>(slot)] + 0x201);
  std::ranges::copy(layout::encode_label({wire::kPartNumber, version, kSlotOrigins[static_cast<std::size_t>(slot)]}),
                    image.begin() + layout::kLabelOffset);
  return image;
}

}  // namespace triskin::test
