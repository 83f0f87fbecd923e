// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"

/// The label describes an image of the application and follows its vectors. See docs/flash_layout.md, "Firmware files".
namespace triskin::layout {

/// The label follows the 118 interrupt vectors of the microcontroller.
inline constexpr std::size_t kLabelOffset = 0x1D8, kLabelBytes = 24;
inline constexpr std::array<std::uint8_t, 4> kLabelMagic{'T', 'S', 'K', 'L'};
inline constexpr std::uint8_t kLabelVersion = 1;

struct ImageLabel {
  std::array<std::uint8_t, 8> hardware{};  ///< The image runs on boards with this part number only.
  /// The major number is in the highest byte, so that versions compare as integers.
  std::uint32_t firmware_version = 0;
  std::uint32_t origin = 0;  ///< The image is linked for this address and would not run elsewhere.
  bool operator==(const ImageLabel&) const = default;
};

/// Encodes a label in its flash format.
[[nodiscard]] constexpr std::array<std::uint8_t, kLabelBytes> encode_label(const ImageLabel& label) {
  std::array<std::uint8_t, kLabelBytes> bytes{};
  ByteWriter w(bytes);
  w.bytes(kLabelMagic);
  w.u8(kLabelVersion);
  w.u8(0);
  w.le16(0);
  w.bytes(label.hardware);
  w.le32(label.firmware_version);
  w.le32(label.origin);
  return bytes;
}

/// Reads the label of an image. Errors: kTooShort, kBadMagic (no label), kBadVersion.
[[nodiscard]] constexpr Result<ImageLabel> decode_label(Bytes image) {
  if (image.size() < kLabelOffset + kLabelBytes) return std::unexpected(Status::kTooShort);
  const Bytes bytes = image.subspan(kLabelOffset, kLabelBytes);
  for (std::size_t k = 0; k < kLabelMagic.size(); ++k) {
    if (bytes[k] != kLabelMagic[k]) return std::unexpected(Status::kBadMagic);
  }
  ByteReader r(bytes.subspan(kLabelMagic.size()));
  if (r.u8() != kLabelVersion) return std::unexpected(Status::kBadVersion);
  ImageLabel label;
  (void)r.u8();
  (void)r.le16();
  for (std::uint8_t& b : label.hardware) b = r.u8();
  label.firmware_version = r.le32();
  label.origin = r.le32();
  return label;
}

}  // namespace triskin::layout
