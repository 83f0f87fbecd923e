// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/patch_image.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/identifiers.hpp"

/// Tells which modules of its own patch a controller of switched modules cannot reach, and which modules of a
/// neighbouring patch it reads. See docs/switched_module.md.
namespace triskin::wire {

inline constexpr std::uint32_t kReachBase = 0x18E3FF00;

/// A controller sends this event when a field changes, and every second while one of the first two fields is not 0.
struct Reach {
  std::uint8_t node_address = 0;
  std::uint16_t out_of_reach = 0;    ///< Bit r says that no working route leads to row r, so neighbours may adopt it.
  std::uint8_t adopted_modules = 0;  ///< The controller reads this many modules of other patches.
  std::uint8_t list = 0;             ///< Samples carry the number of the list that they refer to (Adoption::list).
  bool operator==(const Reach&) const = default;
};

/// Encodes a classic frame of 4 bytes with identifier kReachBase + node address: rows (2), adopted modules (1), list
/// (1).
[[nodiscard]] constexpr CanFrame encode_reach(const Reach& r) {
  CanFrame f;
  f.id = kReachBase | r.node_address;
  f.extended = true;
  f.size = 4;
  f.data[0] = static_cast<std::uint8_t>(r.out_of_reach);
  f.data[1] = static_cast<std::uint8_t>(r.out_of_reach >> 8);
  f.data[2] = r.adopted_modules;
  f.data[3] = r.list;
  return f;
}

/// Decodes the frame. Errors: kOutOfRange (another identifier, an invalid node address, more adopted modules than a
/// patch can have), kBadLength.
[[nodiscard]] constexpr Result<Reach> decode_reach(const CanFrame& f) {
  const auto node = static_cast<std::uint8_t>(f.id);
  if (!f.extended || (f.id & ~std::uint32_t{0xFF}) != kReachBase || !layout::is_node_address(node))
    return std::unexpected(Status::kOutOfRange);
  if (f.size != 4) return std::unexpected(Status::kBadLength);
  const Reach reach{node, static_cast<std::uint16_t>(f.data[0] | f.data[1] << 8), f.data[2], f.data[3]};
  if (reach.adopted_modules >= layout::kMaxModules) return std::unexpected(Status::kOutOfRange);
  return reach;
}

/// The controller reads this module of another patch; the host recognizes it by the port that it is connected to.
struct AdoptedModule {
  std::uint8_t parent = 0;       ///< The parent is a row of the table, or an adopted module earlier in this list.
  std::uint8_t parent_port = 0;  ///< This port of the parent, 0 to 2, leads to the adopted module.
  std::uint8_t port = 0;         ///< This port of the adopted module, 0 to 2, leads to the parent.
  std::uint8_t place = 0;        ///< The place is 4 · line + address, from 0 to 15.
  [[nodiscard]] constexpr std::uint8_t line() const { return place / layout::kAddressesPerLine; }
  [[nodiscard]] constexpr std::uint8_t address() const { return place % layout::kAddressesPerLine; }
  bool operator==(const AdoptedModule&) const = default;
};

/// Identifier FD0E carries this value; see Reach. In the full stream, adopted module k has row `rows of the table` + k;
/// FD0C has only rows of the table.
struct Adoption {
  static constexpr std::uint16_t kId = did::kAdoption;
  static constexpr std::size_t kMinBytes = 4, kAdoptedBytes = 4, kMaxAdopteds = layout::kMaxModules - 1,
                               kMaxBytes = kMinBytes + kAdoptedBytes * kMaxAdopteds;
  std::uint8_t rows = 0;  ///< Numbers of adopted modules begin after the rows of the controller's own table.
  std::uint16_t out_of_reach = 0;
  /// The list gets the next number, 1 to 255, whenever the adopted modules change, and samples carry it; 0 means none.
  std::uint8_t list = 0;
  std::uint8_t count = 0;
  std::array<AdoptedModule, kMaxAdopteds> adopted_modules{};

  [[nodiscard]] constexpr std::span<const AdoptedModule> list_of_adopted() const {
    return {adopted_modules.data(), count};
  }

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    out.u8(rows);
    out.le16(out_of_reach);
    out.u8(list);
    for (const AdoptedModule& g : list_of_adopted()) {
      out.u8(g.parent);
      out.u8(g.parent_port);
      out.u8(g.port);
      out.u8(g.place);
    }
  }
  /// Decodes the wire format. Errors: kTooShort, kBadLength, kOutOfRange (more modules than a controller reads, a
  /// parent that does not precede the adopted module, a port or place that does not exist), kDuplicate (two adopted
  /// modules at one place).
  [[nodiscard]] static constexpr Result<Adoption> decode(Bytes bytes) {
    if (bytes.size() < kMinBytes) return std::unexpected(Status::kTooShort);
    if (bytes.size() > kMaxBytes || (bytes.size() - kMinBytes) % kAdoptedBytes != 0)
      return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    Adoption a;
    a.rows = r.u8();
    a.out_of_reach = r.le16();
    a.list = r.u8();
    a.count = static_cast<std::uint8_t>((bytes.size() - kMinBytes) / kAdoptedBytes);
    if (a.rows + a.count > layout::kMaxModules) return std::unexpected(Status::kOutOfRange);
    std::uint32_t places = 0;
    for (std::size_t k = 0; k < a.count; ++k) {
      AdoptedModule& g = a.adopted_modules[k];
      g.parent = r.u8();
      g.parent_port = r.u8();
      g.port = r.u8();
      g.place = r.u8();
      if (g.parent >= a.rows + k || g.parent_port >= layout::kPorts || g.port >= layout::kPorts ||
          g.place >= layout::kMaxModules)
        return std::unexpected(Status::kOutOfRange);
      if ((places >> g.place & 1U) != 0) return std::unexpected(Status::kDuplicate);
      places |= 1U << g.place;
    }
    return a;
  }
  bool operator==(const Adoption&) const = default;
};
static_assert(kLengthsAsInTable<Adoption>);

}  // namespace triskin::wire
