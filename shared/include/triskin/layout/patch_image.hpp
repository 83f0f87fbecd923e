// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/layout/joint_end.hpp"
#include "triskin/layout/module.hpp"

/// The patch image is the table that is flashed into one controller (docs/flash_layout.md). It is little-endian: a
/// header of 32 bytes, then a row of 12 bytes for each module. The limits are those of layout/module.hpp.
namespace triskin::layout {

/// Raise it when a field changes, because readers refuse other versions.
inline constexpr std::uint16_t kLayoutVersion = 1;
inline constexpr std::uint32_t kMagic = 0x4E4B5354;  ///< In memory these bytes read "TSKN".
inline constexpr std::uint8_t kNoParent = 0xFF;
/// The entry module has this parent_port, because its parent is the cable.
inline constexpr std::uint8_t kCable = kPorts;
inline constexpr std::size_t kHeaderBytes = 32;
inline constexpr std::size_t kRowBytes = 12;
/// This flag in the header says that the electrodes are connected to the positive input.
inline constexpr std::uint8_t kPositiveInput = 1;
/// If a design has kinds, the three high bits of a module id are the number of the kind; a controller does not
/// interpret the id.
inline constexpr unsigned kKindShift = 13;
inline constexpr std::size_t kMaxKinds = 8;  ///< The limit includes the standard kind, which has number 0.
/// A design with kinds can use only this many module ids.
inline constexpr unsigned kIdsBesideKinds = 1U << kKindShift;
inline constexpr std::size_t kMaxImageBytes = kHeaderBytes + kMaxModules * kRowBytes;

/// One row holds both the address and the route of a module, so that they cannot disagree.
struct ModuleRow {
  /// The design file uses the same id; designs with kinds store the kind here too (kKindShift).
  std::uint16_t module_id = 0;
  std::uint8_t line = 0;            ///< Valid values are 0 to 3.
  std::uint8_t address = 0;         ///< Valid values are 0 to 3; cdc_address(address) gives the I²C address.
  std::uint8_t rotation = 0;        ///< Valid values are 0 to 2; they name the tile side that has port A.
  std::uint8_t parent = kNoParent;  ///< The parent's row always precedes this row; the entry has kNoParent.
  /// The lines reach this module through this port (0..2) of its parent; the entry has kCable.
  std::uint8_t parent_port = kCable;
  std::array<std::uint8_t, kPorts>
      joints{};  ///< Each port names its far end as a joint_to byte, even for joints outside the tree; 0 means none.
  bool operator==(const ModuleRow&) const = default;
};

struct PatchImage {
  std::uint64_t design_id = 0;
  /// The image is meant for the controller with this address, kFirstNode … kLastNode.
  std::uint8_t node_address = kFirstNode;
  std::uint8_t module_count = 0;  ///< Valid values are 1 to 16.
  /// Switched modules can have a second cable at this port, given as a joint_to byte; 0 means none.
  std::uint8_t second_entry = 0;
  /// True means that the electrodes are on the converter's positive input and the controller inverts the results.
  bool positive_input = false;
  std::array<ModuleRow, kMaxModules> modules{};
  /// Returns the rows in use, with parents before children.
  [[nodiscard]] constexpr std::span<const ModuleRow> rows() const { return {modules.data(), module_count}; }
  bool operator==(const PatchImage&) const = default;
};

/// Returns true if any joint is listed. Tables for strapped modules may leave all joints out, because nothing can be
/// switched there.
[[nodiscard]] constexpr bool has_joints(const PatchImage& image) {
  for (const ModuleRow& m : image.rows()) {
    for (const std::uint8_t j : m.joints) {
      if (j != 0) return true;
    }
  }
  return false;
}

/// Returns the port of a row that faces its parent, or the cable at the entry. A table without joints gives port A.
[[nodiscard]] constexpr std::uint8_t input_port(const PatchImage& image, std::size_t row) {
  const ModuleRow& m = image.modules[row];
  if (row == 0 || !has_joints(image) || m.parent >= image.module_count || m.parent_port >= kPorts) return 0;
  const std::uint8_t j = image.modules[m.parent].joints[m.parent_port];
  return j == 0 ? std::uint8_t{0} : joint_port(j);
}

/// For each row, bit p is set if port p carries the lines: the port towards the parent (at the entry, the cable) and
/// the ports towards children. On strapped modules the joints of all other ports are cut.
[[nodiscard]] constexpr std::array<std::uint8_t, kMaxModules> kept_ports(const PatchImage& image) {
  std::array<std::uint8_t, kMaxModules> kept{};
  const auto keep = [&](std::size_t row, unsigned port) {
    kept[row] = static_cast<std::uint8_t>(kept[row] | 1U << port);
  };
  for (std::size_t k = 0; k < image.module_count; ++k) {
    keep(k, input_port(image, k));
    if (k > 0) keep(image.modules[k].parent, image.modules[k].parent_port);
  }
  return kept;
}

/// Checks that every joint has two ends and none at a cable, and that every module has a joint. Returns kOk;
/// kOutOfRange for a joint to a module that does not exist; kBadTree if another rule is broken.
[[nodiscard]] constexpr Status check_joints(const PatchImage& image) {
  if (image.second_entry != 0) {
    if (image.second_entry > joint_to(image.module_count - 1U, kPorts - 1)) return Status::kOutOfRange;
    if (image.second_entry == joint_to(0, 0) || !has_joints(image)) return Status::kBadTree;
    if (image.modules[joint_row(image.second_entry)].joints[joint_port(image.second_entry)] != 0)
      return Status::kBadTree;
  }
  if (!has_joints(image)) return Status::kOk;
  if (image.modules[0].joints[0] != 0) return Status::kBadTree;
  for (std::size_t k = 0; k < image.module_count; ++k) {
    for (std::size_t p = 0; p < kPorts; ++p) {
      const std::uint8_t j = image.modules[k].joints[p];
      if (j == 0) continue;
      if (j > joint_to(image.module_count - 1U, kPorts - 1)) return Status::kOutOfRange;
      if (joint_row(j) == k || image.modules[joint_row(j)].joints[joint_port(j)] != joint_to(k, p))
        return Status::kBadTree;
    }
    if (k == 0) continue;
    const ModuleRow& m = image.modules[k];
    const std::uint8_t j = image.modules[m.parent].joints[m.parent_port];
    if (j == 0 || joint_row(j) != k) return Status::kBadTree;
  }
  return Status::kOk;
}

/// Checks ranges, that (line, address) and module ids are unique, that row 0 is the only entry, that parents precede
/// children, that children use different ports of a parent and never its input port, and the joints (check_joints).
[[nodiscard]] constexpr Status check(const PatchImage& image) {
  if (image.module_count < 1 || image.module_count > kMaxModules) return Status::kOutOfRange;
  if (!is_node_address(image.node_address)) return Status::kOutOfRange;
  std::array<bool, kMaxModules> slot{};
  std::array<std::uint8_t, kMaxModules> used_ports{};
  for (std::size_t k = 0; k < image.module_count; ++k) {
    const ModuleRow& m = image.modules[k];
    if (m.line >= kLines || m.address >= kAddressesPerLine || m.rotation >= kRotations) return Status::kOutOfRange;
    bool& taken = slot[static_cast<std::size_t>(m.line * kAddressesPerLine + m.address)];
    if (taken) return Status::kDuplicate;
    taken = true;
    for (std::size_t o = 0; o < k; ++o) {
      if (image.modules[o].module_id == m.module_id) return Status::kDuplicate;
    }
    if ((k == 0) != (m.parent == kNoParent) || (k == 0) != (m.parent_port == kCable)) return Status::kBadTree;
    if (k == 0) continue;
    if (m.parent >= k) return Status::kBadTree;
    if (m.parent_port >= kPorts || m.parent_port == input_port(image, m.parent)) return Status::kBadTree;
    const auto bit = static_cast<std::uint8_t>(1U << m.parent_port);
    if ((used_ports[m.parent] & bit) != 0) return Status::kBadTree;
    used_ports[m.parent] = static_cast<std::uint8_t>(used_ports[m.parent] | bit);
  }
  return check_joints(image);
}

/// Writes the header (magic, layout version, header bytes, total bytes, node address, module count, design id, second
/// entry, flags, 6 reserved zeros, CRC-32 of everything else) and the rows. Returns the bytes written. Errors: those of
/// check(); kNoSpace.
[[nodiscard]] constexpr Result<std::size_t> encode(const PatchImage& image, std::span<std::uint8_t> out) {
  if (const Status s = check(image); s != Status::kOk) return std::unexpected(s);
  const std::size_t total = kHeaderBytes + image.module_count * kRowBytes;
  if (out.size() < total) return std::unexpected(Status::kNoSpace);
  ByteWriter w(out.first(total));
  w.le32(kMagic);
  w.le16(kLayoutVersion);
  w.le16(static_cast<std::uint16_t>(kHeaderBytes));
  w.le16(static_cast<std::uint16_t>(total));
  w.u8(image.node_address);
  w.u8(image.module_count);
  w.le64(image.design_id);
  w.u8(image.second_entry);
  w.u8(image.positive_input ? kPositiveInput : std::uint8_t{0});
  w.bytes(std::array<std::uint8_t, 6>{});
  w.le32(0);  // The CRC is filled in when all other bytes are known.
  const auto kept = kept_ports(image);
  for (std::size_t k = 0; k < image.module_count; ++k) {
    const ModuleRow& m = image.modules[k];
    w.le16(m.module_id);
    w.u8(m.line);
    w.u8(m.address);
    w.u8(m.rotation);
    w.u8(m.parent);
    w.u8(m.parent_port);
    w.u8(kept[k]);
    w.bytes(m.joints);
    w.u8(0);
  }
  const std::uint32_t crc = crc32(out.first(total));
  ByteWriter(out.subspan(28, 4)).le32(crc);
  return total;
}

/// Reads and checks an image; `bytes` may be longer than the image (a flash slot). Errors: kTooShort, kBadMagic,
/// kBadVersion, kBadLength, kBadCrc, then those of check(); kBadTree if kept ports are given that differ from the
/// tree's.
[[nodiscard]] constexpr Result<PatchImage> decode(Bytes bytes) {
  if (bytes.size() < kHeaderBytes) return std::unexpected(Status::kTooShort);
  ByteReader r(bytes);
  if (r.le32() != kMagic) return std::unexpected(Status::kBadMagic);
  if (r.le16() != kLayoutVersion) return std::unexpected(Status::kBadVersion);
  const std::size_t header = r.le16(), total = r.le16();
  PatchImage image;
  image.node_address = r.u8();
  const std::size_t count = image.module_count = r.u8();
  if (count > kMaxModules) return std::unexpected(Status::kOutOfRange);
  if (header != kHeaderBytes || total != kHeaderBytes + count * kRowBytes) return std::unexpected(Status::kBadLength);
  if (bytes.size() < total) return std::unexpected(Status::kTooShort);
  image.design_id = r.le64();
  image.second_entry = r.u8();
  const std::uint8_t flags = r.u8();
  image.positive_input = (flags & kPositiveInput) != 0;
  std::uint8_t reserved = static_cast<std::uint8_t>(flags & ~kPositiveInput);
  for (int k = 0; k < 6; ++k) reserved = static_cast<std::uint8_t>(reserved | r.u8());
  const std::uint32_t stated = r.le32();
  constexpr std::array<std::uint8_t, 4> kZeros{};
  const std::uint32_t crc = crc32(bytes.subspan(32, total - 32), crc32(kZeros, crc32(bytes.first(28))));
  if (crc != stated) return std::unexpected(Status::kBadCrc);
  if (reserved != 0) return std::unexpected(Status::kOutOfRange);
  std::array<std::uint8_t, kMaxModules> kept{};
  std::size_t k = 0;
  for (ModuleRow& m : std::span(image.modules).first(count)) {
    const auto row = bytes.subspan(kHeaderBytes + k * kRowBytes).first<kRowBytes>();
    if (row[kRowBytes - 1] != 0) return std::unexpected(Status::kOutOfRange);
    m.module_id = static_cast<std::uint16_t>(row[0] | row[1] << 8);
    m.line = row[2];
    m.address = row[3];
    m.rotation = row[4];
    m.parent = row[5];
    m.parent_port = row[6];
    kept[k++] = row[7];
    m.joints = {row[8], row[9], row[10]};
  }
  if (const Status s = check(image); s != Status::kOk) return std::unexpected(s);
  const bool given = kept != decltype(kept){};  // Zeros everywhere mean that the image leaves the kept ports out.
  if (given && kept != kept_ports(image)) return std::unexpected(Status::kBadTree);
  return image;
}

}  // namespace triskin::layout
