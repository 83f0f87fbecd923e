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

/// What a controller of switched modules does not reach of its own patch, and which modules of a neighbouring patch it
/// reads. docs/adoption.md.
namespace triskin::wire {

inline constexpr std::uint32_t kReachBase = 0x18E3FF00;

/// Event: sent by a controller when one of the fields changes, and each second while one of the first two is not 0.
struct Reach {
  std::uint8_t node_address = 0;
  std::uint16_t out_of_reach = 0;    ///< Bit r says that no working route leads to row r, so neighbours may adopt it.
  std::uint8_t adopted_modules = 0;  ///< So many modules of other patches are read by this controller.
  std::uint8_t list = 0;             ///< Samples name the list that they refer to, see Adoption::list.
  bool operator==(const Reach&) const = default;
};

/// A classic frame of 4 bytes at kReachBase + node address: rows (2), adopted modules (1), list (1).
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

/// Errors: kOutOfRange (another identifier, no node address, more adopted modules than a patch has modules),
/// kBadLength.
[[nodiscard]] constexpr Result<Reach> decode_reach(const CanFrame& f) {
  const auto node = static_cast<std::uint8_t>(f.id);
  if (!f.extended || (f.id & ~std::uint32_t{0xFF}) != kReachBase || !layout::is_node_address(node))
    return std::unexpected(Status::kOutOfRange);
  if (f.size != 4) return std::unexpected(Status::kBadLength);
  const Reach reach{node, static_cast<std::uint16_t>(f.data[0] | f.data[1] << 8), f.data[2], f.data[3]};
  if (reach.adopted_modules >= layout::kMaxModules) return std::unexpected(Status::kOutOfRange);
  return reach;
}

/// A module of another patch that a controller reads: where it hangs, which tells what module it is.
struct AdoptedModule {
  std::uint8_t parent = 0;       ///< The parent is a row of the table, or an adopted module listed before this one.
  std::uint8_t parent_port = 0;  ///< It ranges from 0 to 2: the parent's port that leads to the adopted module.
  std::uint8_t port = 0;         ///< It ranges from 0 to 2: the adopted module's port that leads to the parent.
  std::uint8_t place = 0;        ///< It is 4 · line + address and ranges from 0 to 15.
  [[nodiscard]] constexpr std::uint8_t line() const { return place / layout::kAddressesPerLine; }
  [[nodiscard]] constexpr std::uint8_t address() const { return place % layout::kAddressesPerLine; }
  bool operator==(const AdoptedModule&) const = default;
};

/// FD0E: see Reach; adopted module k has row `rows of the table` + k in the full stream. FD0C has rows of the table
/// only.
struct Adoption {
  static constexpr std::uint16_t kId = did::kAdoption;
  static constexpr std::size_t kMinBytes = 4, kAdoptedBytes = 4, kMaxAdopteds = layout::kMaxModules - 1,
                               kMaxBytes = kMinBytes + kAdoptedBytes * kMaxAdopteds;
  std::uint8_t rows = 0;  ///< Adopted modules are numbered after these rows of the controller's own table.
  std::uint16_t out_of_reach = 0;
  /// Each change of the adopted modules gives the list the next number from 1 to 255, and samples carry it; 0 means
  /// none.
  std::uint8_t list = 0;
  std::uint8_t count = 0;
  std::array<AdoptedModule, kMaxAdopteds> adopted_modules{};

  [[nodiscard]] constexpr std::span<const AdoptedModule> list_of_adopted() const {
    return {adopted_modules.data(), count};
  }

  /// Appends the value as it stands on the wire.
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
  /// Errors: kTooShort, kBadLength, kOutOfRange (more modules than a controller reads, a parent that is not before the
  /// adopted module, a port or place that does not exist), kDuplicate (two adopted modules at one place).
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
