// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"

/// A firmware file contains the application twice, linked for slot A and for slot B. See docs/flash_layout.md,
/// "Firmware package".
namespace triskin::layout {

/// The flash erases whole pages of this size (RM0440 §3, as in sim/flash_model.hpp).
inline constexpr std::uint32_t kFlashPageBytes = 2048;

inline constexpr std::array<std::uint8_t, 4> kPackageMagic{'T', 'S', 'K', 'F'};
inline constexpr std::uint16_t kPackageVersion = 1;
inline constexpr std::size_t kPackageHeadBytes = 32;
inline constexpr std::uint32_t kMaxFirmwareImageBytes = 0x3C000 - kFlashPageBytes;

struct PackageHead {
  std::uint32_t firmware_version = 0;
  /// Both arrays are indexed by slot, and sizes are multiples of 8.
  std::array<std::uint32_t, 2> size_bytes{}, crc{};
  /// Returns the offset in bytes of the image for a slot (0 or 1) in the package.
  [[nodiscard]] constexpr std::uint32_t offset(int slot) const {
    return static_cast<std::uint32_t>(kPackageHeadBytes) + (slot == 0 ? 0 : size_bytes[0]);
  }
  /// Returns the size of the whole package in bytes.
  [[nodiscard]] constexpr std::uint32_t total() const { return offset(1) + size_bytes[1]; }
};

/// Decodes and checks the head. Errors: kTooShort, kBadMagic, kBadVersion, kBadCrc (of the head), kOutOfRange (sizes).
[[nodiscard]] constexpr Result<PackageHead> decode_package_head(Bytes bytes) {
  if (bytes.size() < kPackageHeadBytes) return std::unexpected(Status::kTooShort);
  for (std::size_t k = 0; k < kPackageMagic.size(); ++k) {
    if (bytes[k] != kPackageMagic[k]) return std::unexpected(Status::kBadMagic);
  }
  ByteReader r(bytes.subspan(kPackageMagic.size()));
  if (r.le16() != kPackageVersion || r.le16() != kPackageHeadBytes) return std::unexpected(Status::kBadVersion);
  PackageHead head;
  head.firmware_version = r.le32();
  for (std::uint32_t& v : head.size_bytes) v = r.le32();
  for (std::uint32_t& v : head.crc) v = r.le32();
  if (r.le32() != crc32(bytes.first(kPackageHeadBytes - 4))) return std::unexpected(Status::kBadCrc);
  for (const std::uint32_t size : head.size_bytes) {
    if (size < 512 || size > kMaxFirmwareImageBytes || size % 8 != 0) return std::unexpected(Status::kOutOfRange);
  }
  return head;
}

inline constexpr std::uint32_t kCommitMagic = 0x4D4D4F43;  ///< In memory these bytes read "COMM".

/// Computes the CRC of the first twelve bytes of a commit record; slot_crc() continues from it.
[[nodiscard]] constexpr std::uint32_t slot_crc_head(std::uint32_t sequence, std::uint32_t size_bytes) {
  std::array<std::uint8_t, 12> head{};
  ByteWriter w(head);
  w.le32(kCommitMagic);
  w.le32(sequence);
  w.le32(size_bytes);
  return crc32(head);
}
/// CRC of the first twelve bytes of a commit record and of the image, so that it also protects size and sequence.
[[nodiscard]] constexpr std::uint32_t slot_crc(std::uint32_t sequence, Bytes image) {
  return crc32(image, slot_crc_head(sequence, static_cast<std::uint32_t>(image.size())));
}

}  // namespace triskin::layout
