// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/layout/firmware_package.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/checked_enum.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/uds.hpp"

/// Sends one image to all controllers of a bus at once (docs/protocol.md, "One image to all"). The running application
/// writes it into the slot that it does not run from.
///
/// Commands are classic frames of eight bytes: command, session (2), five bytes. Data frames carry whole units of the
/// image, and their identifier contains the number of the first unit. Answers use the identifier of the controller's
/// claim; their first byte never occurs in a claim.
namespace triskin::wire::update {

inline constexpr std::uint8_t kProtocol = 1;
inline constexpr std::uint32_t kCommandId = 0x1BF40000;
/// Data identifiers are kDataBase | slot << 16 | number of the first unit. They have a lower priority than samples and
/// requests.
inline constexpr std::uint32_t kDataBase = 0x1BF80000, kDataMask = 0x1FFE0000;
inline constexpr std::size_t kUnitBytes = 8;  ///< The flash is programmed in units of this size.
inline constexpr std::size_t kMaxUnits = layout::kMaxFirmwareImageBytes / kUnitBytes;
/// A session ends after this much silence.
inline constexpr std::uint64_t kPatience_us = 10'000'000;
/// Two data frames for one slot need this pause per unit, because the flash takes 82 µs and the lines must be served.
inline constexpr std::uint64_t kUnit_us = 110;

enum class Command : std::uint8_t {
  kAsk = 1,        ///< One board answers who it is and how its update stands, in any session.
  kSize = 2,       ///< The host offers slot (1 byte), flags (1; bit 0 allows an older version), size of the image (3).
  kVersion = 3,    ///< The host offers firmware version (4 bytes), key (1).
  kHardware = 4,   ///< The host offers CRC-32 of the part number (4 bytes).
  kCrc = 5,        ///< The host offers CRC-32 of the image (4 bytes), which completes the offer for that slot.
  kJoin = 6,       ///< One board takes part if it can use the offer for its free slot.
  kErase = 7,      ///< All that take part erase what the image needs.
  kMissing = 8,    ///< One board answers which units it has not received.
  kCheck = 9,      ///< All that take part check the image.
  kActivate = 10,  ///< All that are ready commit the image and restart.
  kEnd = 11,       ///< The session is over; a board that has not activated the image keeps its old one.
};
/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<Command> to_command(std::uint8_t number) {
  if (number == 0) return std::unexpected(Status::kOutOfRange);
  return checked_enum(number, Command::kEnd);
}
/// Returns true for a command whose argument is the CRC-32 of one controller's unique id.
[[nodiscard]] constexpr bool is_to_one(Command c) {
  return c == Command::kAsk || c == Command::kJoin || c == Command::kMissing;
}

/// A controller goes through these phases in an update.
enum class Phase : std::uint8_t {
  kIdle = 0,       ///< The board takes no part.
  kJoined = 1,     ///< The board takes part and has erased nothing yet.
  kErasing = 2,    ///< The board erases its free slot.
  kReceiving = 3,  ///< The board takes data.
  kChecking = 4,   ///< The board checks the image.
  kReady = 5,      ///< The image is complete and correct.
  kRefused = 6,    ///< The status says why the board refused; its old image continues.
  kActivated = 7,  ///< The image is committed, and the board restarts.
};

/// An order is one command frame of an update session.
struct Order {
  Command command = Command::kAsk;
  std::uint16_t session = 0;  ///< The host draws a random number that is never 0.
  /// The layout of the arguments depends on the command (see Command) and is little-endian.
  std::array<std::uint8_t, 5> arguments{};
  bool operator==(const Order&) const = default;
};

/// Encodes a command as a frame.
[[nodiscard]] constexpr CanFrame encode_order(const Order& o) {
  CanFrame f;
  f.id = kCommandId;
  f.extended = true;
  f.size = 8;
  ByteWriter w(f.data);
  w.u8(wire_number(o.command));
  w.le16(o.session);
  w.bytes(o.arguments);
  return f;
}
/// Decodes a command frame. Errors: kBadLength, kOutOfRange (another identifier, no such command).
[[nodiscard]] constexpr Result<Order> decode_order(const CanFrame& f) {
  if (!f.extended || f.id != kCommandId) return std::unexpected(Status::kOutOfRange);
  if (f.size != 8) return std::unexpected(Status::kBadLength);
  ByteReader r(f.payload());
  const auto command = to_command(r.u8());
  if (!command) return std::unexpected(command.error());
  Order o;
  o.command = *command;
  o.session = r.le16();
  for (std::uint8_t& b : o.arguments) b = r.u8();
  return o;
}
/// Makes a command to one controller: its arguments are the CRC-32 of the unique id.
[[nodiscard]] constexpr Order order_to(Command command, std::uint16_t session, std::uint32_t id_crc) {
  Order o{command, session, {}};
  ByteWriter(o.arguments).le32(id_crc);
  return o;
}

/// An offer describes the image for one slot.
struct Offer {
  std::uint8_t slot = 0;
  bool may_be_older = false;
  std::uint32_t size_bytes = 0;  ///< The size is a multiple of kUnitBytes, from 512 to layout::kMaxFirmwareImageBytes.
  std::uint32_t firmware_version = 0;
  std::uint32_t hardware_crc = 0;  ///< Boards compare this with the CRC-32 of their own part number.
  std::uint32_t image_crc = 0;
  bool operator==(const Offer&) const = default;
};
inline constexpr std::array kOfferCommands{Command::kSize, Command::kVersion, Command::kHardware, Command::kCrc};
inline constexpr std::size_t kOfferFrames = kOfferCommands.size();
/// Protects an offer against accidents, but not against intent (docs/decisions.md).
[[nodiscard]] constexpr std::uint8_t offer_key(std::uint16_t session, std::uint32_t firmware_version) {
  return static_cast<std::uint8_t>(security_key(firmware_version ^ session) & 0xFF);
}
/// Returns the frames of an offer in the order in which they must be sent.
[[nodiscard]] constexpr std::array<Order, kOfferFrames> encode_offer(const Offer& o, std::uint16_t session) {
  std::array<Order, kOfferFrames> orders{};
  for (std::size_t k = 0; k < orders.size(); ++k) orders[k] = {kOfferCommands[k], session, {}};
  ByteWriter size(orders[0].arguments), version(orders[1].arguments);
  size.u8(o.slot);
  size.u8(o.may_be_older ? 1 : 0);
  size.le16(static_cast<std::uint16_t>(o.size_bytes));
  size.u8(static_cast<std::uint8_t>(o.size_bytes >> 16));
  version.le32(o.firmware_version);
  version.u8(offer_key(session, o.firmware_version));
  ByteWriter(orders[2].arguments).le32(o.hardware_crc);
  ByteWriter(orders[3].arguments).le32(o.image_crc);
  return orders;
}

/// Collects the frames of offers. The last frame completes an offer if none before it is missing.
class OfferParts {
 public:
  /// Returns the offer that `order` completes; empty otherwise. A frame out of order or of another session starts a new
  /// offer.
  constexpr std::optional<Offer> add(const Order& order) {
    if (order.command == Command::kSize) next_ = 0;
    if (next_ >= kOfferFrames || order.command != kOfferCommands[next_] || (next_ != 0 && order.session != session_)) {
      next_ = kOfferFrames;
      return std::nullopt;
    }
    session_ = order.session;
    take(order);
    if (++next_ < kOfferFrames || offer_.slot > 1 || !key_fits_) return std::nullopt;
    return offer_;
  }

 private:
  constexpr void take(const Order& order) {
    ByteReader r(order.arguments);
    if (order.command == Command::kSize) {
      offer_.slot = r.u8();
      offer_.may_be_older = (r.u8() & 1) != 0;
      offer_.size_bytes = r.le16();
      offer_.size_bytes |= static_cast<std::uint32_t>(r.u8()) << 16;
    } else if (order.command == Command::kVersion) {
      offer_.firmware_version = r.le32();
      key_fits_ = r.u8() == offer_key(session_, offer_.firmware_version);
    } else if (order.command == Command::kHardware) {
      offer_.hardware_crc = r.le32();
    } else {
      offer_.image_crc = r.le32();
    }
  }
  Offer offer_;
  std::uint16_t session_ = 0;
  bool key_fits_ = false;
  std::size_t next_ = kOfferFrames;
};

/// Returns the frame that carries `units` (8 … 64 bytes, whole units) of the image for `slot`, starting at unit
/// number `first`.
[[nodiscard]] constexpr CanFrame encode_data(std::uint8_t slot, std::uint16_t first, Bytes units) {
  CanFrame f;
  f.id = kDataBase | std::uint32_t{slot} << 16 | first;
  f.extended = true;
  f.fd = f.bit_rate_switch = units.size() > 8;
  f.size = static_cast<std::uint8_t>(units.size());
  std::ranges::copy(units, f.data.begin());
  return f;
}
/// Returns true when the frame carries data for a slot.
[[nodiscard]] constexpr bool is_data(const CanFrame& f) {
  return f.extended && (f.id & kDataMask) == kDataBase;
}
[[nodiscard]] constexpr std::uint8_t data_slot(std::uint32_t id) {
  return static_cast<std::uint8_t>(id >> 16 & 1);
}
[[nodiscard]] constexpr std::uint16_t data_unit(std::uint32_t id) {
  return static_cast<std::uint16_t>(id);
}

/// The first byte of an answer tells its kind.
enum class Answer : std::uint8_t { kWho = 0x10, kState = 0x11, kList = 0x12, kBitmap = 0x13, kImage = 0x14 };

/// Identifies the controller and the image that it runs.
struct Who {
  std::uint8_t protocol = kProtocol;
  std::uint8_t running_slot = 0;  ///< Updates go to the other slot.
  bool confirmed = false;
  std::uint32_t firmware_version = 0;
  bool operator==(const Who&) const = default;
};
/// Identifies the image on a controller, so that the host can compare it with another.
struct Image {
  std::uint32_t record_crc = 0;  ///< The value is layout::slot_crc() of the slot that runs.
  std::uint32_t sequence = 0;    ///< The commit record's sequence number is taken modulo 2^24.
  bool operator==(const Image&) const = default;
};
/// The state tells how far the update is on a controller.
struct State {
  Phase phase = Phase::kIdle;
  Status status = Status::kOk;
  std::uint16_t session = 0;  ///< The board takes part in this session; 0 means that it takes part in none.
  /// After kMissing this counts missing units, otherwise the pages that still have to be erased.
  std::uint16_t count = 0;
  bool operator==(const State&) const = default;
};

/// Encodes an answer in eight bytes.
[[nodiscard]] constexpr std::array<std::uint8_t, 8> encode_who(const Who& who) {
  std::array<std::uint8_t, 8> bytes{};
  ByteWriter w(bytes);
  w.u8(wire_number(Answer::kWho));
  w.u8(who.protocol);
  w.u8(static_cast<std::uint8_t>(who.running_slot | (who.confirmed ? 2 : 0)));
  w.le32(who.firmware_version);
  w.u8(0);
  return bytes;
}
/// Decodes an answer. Errors: kBadLength, kBadMagic (another answer).
[[nodiscard]] constexpr Result<Who> decode_who(Bytes bytes) {
  if (bytes.size() != 8) return std::unexpected(Status::kBadLength);
  ByteReader r(bytes);
  if (r.u8() != wire_number(Answer::kWho)) return std::unexpected(Status::kBadMagic);
  Who who;
  who.protocol = r.u8();
  const std::uint8_t bits = r.u8();
  who.running_slot = bits & 1;
  who.confirmed = (bits & 2) != 0;
  who.firmware_version = r.le32();
  return who;
}
/// Encodes an answer in eight bytes.
[[nodiscard]] constexpr std::array<std::uint8_t, 8> encode_image(const Image& image) {
  std::array<std::uint8_t, 8> bytes{};
  ByteWriter w(bytes);
  w.u8(wire_number(Answer::kImage));
  w.le32(image.record_crc);
  w.le16(static_cast<std::uint16_t>(image.sequence));
  w.u8(static_cast<std::uint8_t>(image.sequence >> 16));
  return bytes;
}
/// Decodes an answer. Errors: kBadLength, kBadMagic (another answer).
[[nodiscard]] constexpr Result<Image> decode_image(Bytes bytes) {
  if (bytes.size() != 8) return std::unexpected(Status::kBadLength);
  ByteReader r(bytes);
  if (r.u8() != wire_number(Answer::kImage)) return std::unexpected(Status::kBadMagic);
  Image image;
  image.record_crc = r.le32();
  image.sequence = r.le16();
  image.sequence |= static_cast<std::uint32_t>(r.u8()) << 16;
  return image;
}
/// Encodes an answer in eight bytes.
[[nodiscard]] constexpr std::array<std::uint8_t, 8> encode_state(const State& state) {
  std::array<std::uint8_t, 8> bytes{};
  ByteWriter w(bytes);
  w.u8(wire_number(Answer::kState));
  w.u8(wire_number(state.phase));
  w.u8(wire_number(state.status));
  w.le16(state.session);
  w.le16(state.count);
  w.u8(0);
  return bytes;
}
/// Decodes an answer. Errors: kBadLength, kBadMagic (another answer), kOutOfRange (no such phase or status).
[[nodiscard]] constexpr Result<State> decode_state(Bytes bytes) {
  if (bytes.size() != 8) return std::unexpected(Status::kBadLength);
  ByteReader r(bytes);
  if (r.u8() != wire_number(Answer::kState)) return std::unexpected(Status::kBadMagic);
  const auto phase = checked_enum(r.u8(), Phase::kActivated);
  const auto status = to_status(r.u8());
  if (!phase || !status) return std::unexpected(Status::kOutOfRange);
  State s{*phase, *status, 0, 0};
  s.session = r.le16();
  s.count = r.le16();
  return s;
}

/// An answer lists missing units in whichever of two forms holds more of them. Both begin with the first missing unit
/// (2 bytes). A list continues with the distances to the next units, 1 … 255, until the end of the frame or a 0; a
/// bitmap has a bit for each unit from the first on, lowest bit first.
class MissingPart {
 public:
  static constexpr std::size_t kHead = 3;
  /// `frame_bytes` is 8, or 64 on a bus with FD; `first` is the first missing unit.
  constexpr MissingPart(std::uint16_t first, std::size_t frame_bytes)
      : bytes_(frame_bytes), first_(first), last_(first) {
    bitmap_[kHead] = 1;
  }
  /// Adds a missing unit, which must come after those before. Returns false if it does not fit into this answer.
  constexpr bool add(std::uint16_t unit) {
    const std::size_t at = static_cast<std::size_t>(unit - first_), step = static_cast<std::size_t>(unit - last_);
    const bool in_bitmap = at < 8 * (bytes_ - kHead);
    const bool in_list = is_list_ && step <= 255 && kHead + listed_ < bytes_;
    if (!in_bitmap && !in_list) return false;
    // Units are added in order, so if this one fits into the bitmap, all earlier ones did.
    if (in_bitmap) bitmap_[kHead + at / 8] |= static_cast<std::uint8_t>(1U << at % 8);
    if (in_list) list_[kHead + listed_++] = static_cast<std::uint8_t>(step);
    is_list_ = in_list;
    last_ = unit;
    return true;
  }
  /// Returns the payload; only its first `frame_bytes` are used.
  [[nodiscard]] constexpr std::array<std::uint8_t, 64> encode() const {
    std::array<std::uint8_t, 64> out = is_list_ ? list_ : bitmap_;
    ByteWriter w(out);
    w.u8(wire_number(is_list_ ? Answer::kList : Answer::kBitmap));
    w.le16(first_);
    return out;
  }

 private:
  std::size_t bytes_;
  std::uint16_t first_, last_;
  std::array<std::uint8_t, 64> list_{}, bitmap_{};
  std::size_t listed_ = 0;
  bool is_list_ = true;
};

/// Calls `found(unit)` for each unit that an answer names. Errors: kTooShort, kBadMagic (another answer), kOutOfRange
/// (a number beyond any image).
template <class Found>
constexpr Status decode_missing(Bytes bytes, Found found) {
  if (bytes.size() < MissingPart::kHead) return Status::kTooShort;
  const bool list = bytes[0] == wire_number(Answer::kList);
  if (!list && bytes[0] != wire_number(Answer::kBitmap)) return Status::kBadMagic;
  std::size_t unit = ByteReader(bytes.subspan(1)).le16();
  const Bytes rest = bytes.subspan(MissingPart::kHead);
  const auto add_unit = [&](std::size_t u) {
    if (u < kMaxUnits) found(static_cast<std::uint16_t>(u));
    return u < kMaxUnits;
  };
  if (list) {
    if (!add_unit(unit)) return Status::kOutOfRange;
    for (std::size_t k = 0; k < rest.size() && rest[k] != 0; ++k) {
      if (!add_unit(unit += rest[k])) return Status::kOutOfRange;
    }
    return Status::kOk;
  }
  for (std::size_t k = 0; k < 8 * rest.size(); ++k) {
    if ((rest[k / 8] >> k % 8 & 1) != 0 && !add_unit(unit + k)) return Status::kOutOfRange;
  }
  return Status::kOk;
}

}  // namespace triskin::wire::update
