// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/core/bytes.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/uds.hpp"
#include "triskin/wire/unique_id.hpp"

/// Finds out who is on the bus and assigns node addresses; it works even while addresses are not unique
/// (docs/protocol.md).
///
/// The host asks with one frame at kWhoIsThereId. Every controller answers with two classic frames whose identifier is
/// made from its unique id, so that two new boards with the same default address never collide in arbitration. The host
/// assigns an address with two frames at kAssignId that name the unique id.
namespace triskin::wire {

inline constexpr std::uint32_t kWhoIsThereId = 0x18E0FFF1, kAssignId = 0x18E1FFF1;
inline constexpr std::uint32_t kClaimBase = 0x1C000000, kClaimMask = 0x03FFFFFF;
inline constexpr std::size_t kClaimFrames = 2;
inline constexpr std::size_t kIdBytesInFirst = 7;

/// Returns the identifier of a controller's answer: 26 bits of the CRC of its unique id.
[[nodiscard]] constexpr std::uint32_t claim_id(const UniqueId& id) {
  return kClaimBase | (crc32(id) & kClaimMask);
}
/// Returns true when the frame is a claim of a controller.
[[nodiscard]] constexpr bool is_claim(const CanFrame& f) {
  return f.extended && (f.id & ~kClaimMask) == kClaimBase;
}

struct NodeClaim {
  UniqueId unique_id{};
  std::uint8_t node_address = 0;
  bool has_table = false;
  bool operator==(const NodeClaim&) const = default;
};

/// Protects an assignment against accidents; the key is the last byte of the second frame.
[[nodiscard]] constexpr std::uint8_t assignment_key(const UniqueId& id, std::uint8_t node_address) {
  return static_cast<std::uint8_t>(security_key(crc32(id) ^ node_address) & 0xFF);
}

/// Builds two frames: 0, unique id bytes 0–6; then 1, bytes 7–11, and two more bytes.
[[nodiscard]] constexpr std::array<CanFrame, kClaimFrames> encode_id_frames(std::uint32_t can_id, const UniqueId& id,
                                                                            std::uint8_t a, std::uint8_t b) {
  std::array<CanFrame, kClaimFrames> frames{};
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].id = can_id;
    frames[k].extended = true;
    frames[k].size = 8;
    frames[k].data[0] = static_cast<std::uint8_t>(k);
  }
  std::copy_n(id.begin(), kIdBytesInFirst, frames[0].data.begin() + 1);
  std::copy(id.begin() + kIdBytesInFirst, id.end(), frames[1].data.begin() + 1);
  frames[1].data[6] = a;
  frames[1].data[7] = b;
  return frames;
}
/// Returns the frames by which a controller reports its unique id and node address, in order.
[[nodiscard]] constexpr auto encode_claim(const NodeClaim& c) {
  return encode_id_frames(claim_id(c.unique_id), c.unique_id, c.node_address, c.has_table ? 1 : 0);
}
/// Returns the frames that assign a node address (1 … 126) to the controller with this unique id, in order.
[[nodiscard]] constexpr auto encode_assignment(const UniqueId& id, std::uint8_t node_address) {
  return encode_id_frames(kAssignId, id, node_address, assignment_key(id, node_address));
}
/// Returns the frame by which a host asks every controller for its claim.
[[nodiscard]] constexpr CanFrame who_is_there() {
  CanFrame f;
  f.id = kWhoIsThereId;
  f.extended = true;
  return f;
}

/// Joins two consecutive frames with the same identifier.
class IdFrames {
 public:
  struct Joined {
    UniqueId unique_id{};
    std::uint8_t a = 0, b = 0;
  };
  /// Returns the pair when `frame` completes one; empty otherwise.
  constexpr std::optional<Joined> add(const CanFrame& frame) {
    if (frame.size != 8 || frame.data[0] > 1) return std::nullopt;
    if (frame.data[0] == 0) {
      std::copy_n(frame.data.begin() + 1, kIdBytesInFirst, joined_.unique_id.begin());
      has_first_ = true;
      return std::nullopt;
    }
    if (!has_first_) return std::nullopt;
    has_first_ = false;
    std::copy_n(frame.data.begin() + 1, 5, joined_.unique_id.begin() + kIdBytesInFirst);
    joined_.a = frame.data[6];
    joined_.b = frame.data[7];
    return joined_;
  }

 private:
  bool has_first_ = false;
  Joined joined_;
};

/// Decodes a claim. Error: kOutOfRange (invalid node address; a table flag other than 0 or 1).
[[nodiscard]] constexpr Result<NodeClaim> decode_claim(const IdFrames::Joined& joined) {
  const auto has_table = checked_bool(joined.b);
  if (!layout::is_node_address(joined.a) || !has_table) return std::unexpected(Status::kOutOfRange);
  return NodeClaim{joined.unique_id, joined.a, *has_table};
}

}  // namespace triskin::wire
