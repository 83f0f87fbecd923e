// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/layout/image_label.hpp"

/// Decides whether an image may be written into a slot. Host, application, loader and DFU all ask here, so no path
/// takes what another refuses. See docs/decisions.md, 0041.
namespace triskin::layout {

/// Slots A and B begin at these addresses on each board (flash_map.hpp of the board).
inline constexpr std::array<std::uint32_t, 2> kSlotOrigins{0x08004000, 0x08040000};

/// What a board accepts as the next image of one slot.
struct ImageTarget {
  std::array<std::uint8_t, 8> hardware{};  ///< part number of the board
  std::uint32_t origin = 0;                ///< address of the slot
  std::uint32_t room_bytes = kMaxFirmwareImageBytes;
  std::uint32_t running_version = 0;  ///< 0 where nobody knows it: the loader, and DFU
  bool may_be_older = false;          ///< the user has asked for it
};

/// Returns true when the first two words of an image, stack and entry, belong to an image of `size_bytes` at `origin`.
[[nodiscard]] constexpr bool vectors_fit(std::uint32_t stack, std::uint32_t entry, std::uint32_t origin,
                                         std::uint32_t size_bytes) {
  constexpr std::uint32_t kRamBase = 0x20000000, kRamEnd = 0x20020000;
  return stack > kRamBase && stack <= kRamEnd && (entry & ~1U) > origin && (entry & ~1U) < origin + size_bytes;
}

/// Returns kOk, or the first reason against the image: kOutOfRange (not a multiple of 8, or too short for a label),
/// kNoSpace, kBadMagic (no label), kBadVersion (of the label), kWrongTarget (other hardware, or linked for another slot
/// or memory map), kOlder. Cost: constant.
[[nodiscard]] constexpr Status check_image(Bytes image, const ImageTarget& target) {
  if (image.size() % 8 != 0 || image.size() < kLabelOffset + kLabelBytes) return Status::kOutOfRange;
  if (image.size() > target.room_bytes) return Status::kNoSpace;
  const auto label = decode_label(image);
  if (!label) return label.error();
  ByteReader vectors(image);
  const std::uint32_t stack = vectors.le32(), entry = vectors.le32();
  if (label->hardware != target.hardware || label->origin != target.origin ||
      !vectors_fit(stack, entry, target.origin, static_cast<std::uint32_t>(image.size())))
    return Status::kWrongTarget;
  if (label->firmware_version < target.running_version && !target.may_be_older) return Status::kOlder;
  return Status::kOk;
}

}  // namespace triskin::layout
