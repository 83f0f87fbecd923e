// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/base/bytes.hpp"
#include "triskin/layout/patch_image.hpp"

/// What a controller of switched modules tells about its patch (docs/protocol.md, FD07 and FD08).
namespace triskin::wire {

inline constexpr std::uint8_t kNoRow = 0xFF;

/// Modules and joints as found on the chain; module 0 is the entry. Numbers are those of the discovery.
struct FoundTopology {
  bool switched = false;      ///< false: nobody answers on the chain; strapped modules, or no power
  bool complete = false;      ///< false: the chain would not settle; what is here is certain, more may be there
  bool second_cable = false;  ///< module 0 is the second entry: nobody, or too few, answered at the first
  std::uint8_t count = 0;
  std::uint8_t cable_port = 0;  ///< of module 0
  std::array<std::array<std::uint8_t, layout::kPorts>, layout::kMaxModules>
      joints{};                                         ///< layout::joint_to of the far end, 0: none
  std::array<std::uint8_t, layout::kMaxModules> row{};  ///< of the table; kNoRow: the table does not know it
  bool operator==(const FoundTopology&) const = default;
};

/// The tree that is active, and how it came about.
struct ActiveRoute {
  bool switched = false;
  bool busy = false;          ///< a new route is being looked for
  bool complete = false;      ///< a tree is up
  bool as_table = false;      ///< it is the table's
  bool least_depth = false;   ///< no tree over the joints found is less deep
  bool second_cable = false;  ///< the tree hangs on the second entry
  std::uint8_t shorts = 0;    ///< ports left closed because opening them broke the chain or held a line
  std::uint8_t unknown = 0;   ///< modules found that the table does not know; left closed
  std::uint8_t max_depth = 0;
  std::uint16_t alive = 0;                                      ///< bit r: row r is in the tree
  std::uint32_t heals = 0;                                      ///< since power-up
  std::uint32_t repairs = 0;                                    ///< registers that had to be written again; no new tree
  std::uint32_t last_us = 0;                                    ///< how long the last one took
  std::array<std::uint8_t, layout::kMaxModules> parent{};       ///< row; kNoRow: the entry, or not in the tree
  std::array<std::uint8_t, layout::kMaxModules> parent_port{};  ///< layout::kCable where there is no parent
  bool operator==(const ActiveRoute&) const = default;
};

/// Flags, count, cable port, then per module three far ends and the row.
constexpr void encode(const FoundTopology& t, ByteWriter& out) {
  out.u8(static_cast<std::uint8_t>((t.switched ? 1 : 0) | (t.complete ? 2 : 0) | (t.second_cable ? 4 : 0)));
  out.u8(t.count);
  out.u8(t.cable_port);
  for (std::size_t m = 0; m < t.count; ++m) {
    out.bytes(t.joints[m]);
    out.u8(t.row[m]);
  }
}

/// False: the bytes make no sense.
[[nodiscard]] constexpr bool decode(Bytes bytes, FoundTopology& t) {
  ByteReader r(bytes);
  t = {};
  const std::uint8_t flags = r.u8();
  t.switched = (flags & 1) != 0;
  t.complete = (flags & 2) != 0;
  t.second_cable = (flags & 4) != 0;
  t.count = r.u8();
  t.cable_port = r.u8();
  if (t.count > layout::kMaxModules || t.cable_port >= layout::kPorts ||
      bytes.size() != 3U + (layout::kPorts + 1U) * t.count)
    return false;
  for (std::size_t m = 0; m < t.count; ++m) {
    for (std::uint8_t& j : t.joints[m]) {
      j = r.u8();
      if (j != 0 && layout::joint_row(j) >= t.count) return false;
    }
    t.row[m] = r.u8();
    if (t.row[m] != kNoRow && t.row[m] >= layout::kMaxModules) return false;
  }
  for (std::size_t m = 0; m < t.count; ++m) {
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      const std::uint8_t j = t.joints[m][p];
      if (j != 0 && t.joints[layout::joint_row(j)][layout::joint_port(j)] != layout::joint_to(m, p)) return false;
    }
  }
  return true;
}

constexpr void encode(const ActiveRoute& a, std::uint8_t rows, ByteWriter& out) {
  out.u8(static_cast<std::uint8_t>((a.switched ? 1 : 0) | (a.busy ? 2 : 0) | (a.complete ? 4 : 0) |
                                   (a.as_table ? 8 : 0) | (a.least_depth ? 16 : 0) | (a.second_cable ? 32 : 0)));
  out.u8(a.shorts);
  out.u8(a.unknown);
  out.u8(a.max_depth);
  out.le16(a.alive);
  out.le32(a.heals);
  out.le32(a.repairs);
  out.le32(a.last_us);
  for (std::size_t k = 0; k < rows; ++k) {
    out.u8(a.parent[k]);
    out.u8(a.parent_port[k]);
  }
}

[[nodiscard]] constexpr bool decode(Bytes bytes, ActiveRoute& a) {
  constexpr std::size_t kHead = 18;
  ByteReader r(bytes);
  a = {};
  const std::uint8_t flags = r.u8();
  a.switched = (flags & 1) != 0;
  a.busy = (flags & 2) != 0;
  a.complete = (flags & 4) != 0;
  a.as_table = (flags & 8) != 0;
  a.least_depth = (flags & 16) != 0;
  a.second_cable = (flags & 32) != 0;
  a.shorts = r.u8();
  a.unknown = r.u8();
  a.max_depth = r.u8();
  a.alive = r.le16();
  a.heals = r.le32();
  a.repairs = r.le32();
  a.last_us = r.le32();
  if (!r.ok() || (bytes.size() - kHead) % 2 != 0 || bytes.size() > kHead + std::size_t{2} * layout::kMaxModules)
    return false;
  a.parent.fill(kNoRow);
  a.parent_port.fill(layout::kCable);
  for (std::size_t k = 0; k < layout::kMaxModules && !r.rest().empty(); ++k) {
    a.parent[k] = r.u8();
    a.parent_port[k] = r.u8();
  }
  return true;
}

}  // namespace triskin::wire
