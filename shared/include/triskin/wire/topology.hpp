// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/identifiers.hpp"

/// A controller with switched modules reports on its patch with FD07, FD08 and routine 0204; see docs/protocol.md.
namespace triskin::wire {

inline constexpr std::uint8_t kNoRow = 0xFF;

/// Identifier FD07 carries modules and joints as found on the chain. Modules have the numbers of the discovery; module
/// 0 is the entry.
struct FoundTopology {
  static constexpr std::uint16_t kId = did::kTopology;
  static constexpr std::size_t kMinBytes = 3, kModuleBytes = layout::kPorts + 1,
                               kMaxBytes = kMinBytes + kModuleBytes * layout::kMaxModules;
  /// False means that no module answers on the chain: the modules are strapped, or have no power.
  bool switched = false;
  /// False means that the chain did not settle: what is listed is certain, but there may be more.
  bool complete = false;
  bool second_cable = false;  ///< Module 0 is the second entry, because no module, or too few, answered at the first.
  std::uint8_t count = 0;
  std::uint8_t cable_port = 0;  ///< The cable is connected to this port of module 0.
  /// Each byte is layout::joint_to of the far end; 0 means none.
  std::array<std::array<std::uint8_t, layout::kPorts>, layout::kMaxModules> joints{};
  std::array<std::uint8_t, layout::kMaxModules>
      row{};  ///< The row can also be an adopted module (Adoption), or kNoRow if the module is neither.

  /// Appends flags, count and cable port, then the far ends and the row of each module.
  constexpr void encode(ByteWriter& out) const {
    out.u8(static_cast<std::uint8_t>((switched ? 1 : 0) | (complete ? 2 : 0) | (second_cable ? 4 : 0)));
    out.u8(count);
    out.u8(cable_port);
    for (std::size_t m = 0; m < count; ++m) {
      out.bytes(joints[m]);
      out.u8(row[m]);
    }
  }
  /// Decodes the wire format. Errors: kTooShort, kBadLength, kOutOfRange (flags, count, port, row, a joint to a missing
  /// module), kBadTree (a joint that only one end lists).
  [[nodiscard]] static constexpr Result<FoundTopology> decode(Bytes bytes);
  bool operator==(const FoundTopology&) const = default;
};
static_assert(kLengthsAsInTable<FoundTopology>);

/// Identifier FD08 carries the tree that is active, and how the controller arrived at it.
struct ActiveRoute {
  static constexpr std::uint16_t kId = did::kRoute;
  static constexpr std::size_t kMinBytes = 18, kRowBytes = 2, kMaxBytes = kMinBytes + kRowBytes * layout::kMaxModules;
  bool switched = false;
  bool busy = false;          ///< The controller is searching for a new route.
  bool complete = false;      ///< A tree is active, and it contains all modules that can be reached.
  bool as_table = false;      ///< The tree is that of the table.
  bool min_depth = false;     ///< No tree over the joints that were found has a smaller depth.
  bool second_cable = false;  ///< The tree starts at the second entry.
  std::uint8_t shorts = 0;  ///< This many ports stay closed, because opening them broke the chain or pulled a line low.
  std::uint8_t unknown = 0;  ///< This many modules are not in the table and stay closed.
  std::uint8_t max_depth = 0;
  std::uint16_t alive = 0;     ///< Bit r says that row r is in the tree.
  std::uint32_t reroutes = 0;  ///< Reroutes are counted from power-up.
  std::uint32_t repairs = 0;   ///< The counter shows how often registers were rewritten without a new tree.
  std::uint32_t last_us = 0;   ///< The last reroute took this long.
  std::uint8_t rows = 0;       ///< The table has this many rows; 0 means that there is no table.
  /// The parent is given as a row; the entry and modules outside the tree have kNoRow.
  std::array<std::uint8_t, layout::kMaxModules> parent{};
  std::array<std::uint8_t, layout::kMaxModules> parent_port{};  ///< layout::kCable means that there is no parent.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(static_cast<std::uint8_t>((switched ? 1 : 0) | (busy ? 2 : 0) | (complete ? 4 : 0) | (as_table ? 8 : 0) |
                                     (min_depth ? 16 : 0) | (second_cable ? 32 : 0)));
    out.u8(shorts);
    out.u8(unknown);
    out.u8(max_depth);
    out.le16(alive);
    out.le32(reroutes);
    out.le32(repairs);
    out.le32(last_us);
    for (std::size_t k = 0; k < rows; ++k) {
      out.u8(parent[k]);
      out.u8(parent_port[k]);
    }
  }
  /// Decodes the wire format. Errors: kTooShort, kBadLength, kOutOfRange (flags, a parent that is no row, a port that
  /// no module has).
  [[nodiscard]] static constexpr Result<ActiveRoute> decode(Bytes bytes);
  bool operator==(const ActiveRoute&) const = default;
};
static_assert(kLengthsAsInTable<ActiveRoute>);

constexpr Result<FoundTopology> FoundTopology::decode(Bytes bytes) {
  if (bytes.size() < kMinBytes) return std::unexpected(Status::kTooShort);
  ByteReader r(bytes);
  FoundTopology t;
  const std::uint8_t flags = r.u8();
  t.switched = (flags & 1) != 0;
  t.complete = (flags & 2) != 0;
  t.second_cable = (flags & 4) != 0;
  t.count = r.u8();
  t.cable_port = r.u8();
  if (flags > 7 || t.count > layout::kMaxModules || t.cable_port >= layout::kPorts)
    return std::unexpected(Status::kOutOfRange);
  const std::size_t count = t.count;
  if (bytes.size() != kMinBytes + kModuleBytes * count) return std::unexpected(Status::kBadLength);
  for (std::size_t m = 0; m < count; ++m) {
    const Bytes module = bytes.subspan(kMinBytes + kModuleBytes * m, kModuleBytes);
    std::ranges::copy(module.first(layout::kPorts), t.joints[m].begin());
    for (const std::uint8_t j : t.joints[m]) {
      if (j != 0 && layout::joint_row(j) >= count) return std::unexpected(Status::kOutOfRange);
    }
    const std::uint8_t row = module[layout::kPorts];
    if (row != kNoRow && row >= layout::kMaxModules) return std::unexpected(Status::kOutOfRange);
    t.row[m] = row;
  }
  for (std::size_t m = 0; m < count; ++m) {
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t j = t.joints[m][p];
      if (j != 0 && t.joints[layout::joint_row(j)][layout::joint_port(j)] != layout::joint_to(m, p))
        return std::unexpected(Status::kBadTree);
    }
  }
  return t;
}

constexpr Result<ActiveRoute> ActiveRoute::decode(Bytes bytes) {
  if (bytes.size() < kMinBytes) return std::unexpected(Status::kTooShort);
  if (bytes.size() > kMaxBytes || (bytes.size() - kMinBytes) % kRowBytes != 0)
    return std::unexpected(Status::kBadLength);
  ByteReader r(bytes);
  ActiveRoute a;
  const std::uint8_t flags = r.u8();
  if (flags > 63) return std::unexpected(Status::kOutOfRange);
  a.switched = (flags & 1) != 0;
  a.busy = (flags & 2) != 0;
  a.complete = (flags & 4) != 0;
  a.as_table = (flags & 8) != 0;
  a.min_depth = (flags & 16) != 0;
  a.second_cable = (flags & 32) != 0;
  a.shorts = r.u8();
  a.unknown = r.u8();
  a.max_depth = r.u8();
  a.alive = r.le16();
  a.reroutes = r.le32();
  a.repairs = r.le32();
  a.last_us = r.le32();
  a.rows = static_cast<std::uint8_t>((bytes.size() - kMinBytes) / kRowBytes);
  a.parent.fill(kNoRow);
  a.parent_port.fill(layout::kCable);
  const std::size_t rows = a.rows;
  for (std::size_t k = 0; k < rows; ++k) {
    a.parent[k] = r.u8();
    a.parent_port[k] = r.u8();
    if ((a.parent[k] != kNoRow && a.parent[k] >= rows) || a.parent_port[k] > layout::kCable)
      return std::unexpected(Status::kOutOfRange);
  }
  return a;
}

/// Routine 0204 returns whether the new tree is active, with all modules that can be reached.
struct RerouteResult {
  static constexpr std::uint16_t kId = routine::kReroute;
  static constexpr std::size_t kMinBytes = 1, kMaxBytes = 1;
  bool done = false;

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const { out.u8(done ? 1 : 0); }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange.
  [[nodiscard]] static constexpr Result<RerouteResult> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    const auto done = checked_bool(bytes[0]);
    if (!done) return std::unexpected(done.error());
    return RerouteResult{*done};
  }
  bool operator==(const RerouteResult&) const = default;
};
static_assert(kResultAsInTable<RerouteResult>);

}  // namespace triskin::wire
