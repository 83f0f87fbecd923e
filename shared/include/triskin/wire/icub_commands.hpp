// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/core/bytes.hpp"
#include "triskin/core/status.hpp"
#include "triskin/wire/can_frame.hpp"
#include "triskin/wire/identifiers.hpp"

/// iCub hosts send these commands to a skin board with 11-bit identifiers: class << 8 | source << 4 | destination. See
/// docs/icub.md; taxel_frames.hpp has the taxels.
namespace triskin::wire::icub {

inline constexpr std::uint32_t kPollingClass = 0x200, kLoaderClass = 0x700, kClassMask = 0x700;
inline constexpr std::uint8_t kEverybody = 0xF;
inline constexpr std::uint8_t kMaxBoard = 14;  ///< A controller with a higher node address cannot be an iCub board.
inline constexpr int kTriangles = 16;          ///< Triangles are numbered 4 · line + address, as on an iCub board.

/// In the polling class the highest bit of the command has no meaning.
inline constexpr std::uint8_t kCommandMask = 0x7F;
/// The first byte starts transmission when it is 0 and stops it otherwise.
inline constexpr std::uint8_t kSetTransmission = 0x07;
/// The host sends the protocol it wants, major and minor, and the board answers.
inline constexpr std::uint8_t kGetVersion = 0x1C;
/// Both classes use this command with the new address as data; the loader also accepts FF and a mask.
inline constexpr std::uint8_t kSetAddress = 0x32;
/// The command sets the defaults at a period of 40 ms, calibrates and starts.
inline constexpr std::uint8_t kSetupObsolete = 0x4C;
inline constexpr std::uint8_t kSetBoard = 0x4D;  ///< The data are skin type, period in ms and the rest value.
/// The data are the first and last triangle, the shift, a byte whose bit 0 enables, and a 16-bit offset.
inline constexpr std::uint8_t kSetTriangles = 0x50;

/// The loader class has these commands.
inline constexpr std::uint8_t kRestart = 0x00;
inline constexpr std::uint8_t kGetDescription = 0x0C;  ///< The board answers with eight frames of four characters.
/// The board answers with the microseconds since power-up in 7 bytes.
inline constexpr std::uint8_t kGetTimeOfLife = 0x0E;
inline constexpr std::uint8_t kDiscover = 0xFF;  ///< The board answers with its type and version.

inline constexpr std::uint8_t kBoardType = 11;  ///< iCub hosts look for the number of the MTB4.
/// The version describes the board's CAN commands.
inline constexpr std::uint8_t kProtocolMajor = 2, kProtocolMinor = 0;
inline constexpr std::uint16_t kUsualOffset = 0x2200;  ///< Every iCub host asks for this converter offset.

/// Selects what is subtracted from a taxel's value. Unknown numbers on the wire are treated as kUncompensated.
enum class SkinType : std::uint8_t {
  kCompensated = 0,    ///< Temperature is compensated.
  kPalm = 1,           ///< Nothing is compensated, because the gains of the palm are zero.
  kUncompensated = 2,  ///< Only the value at the calibration is subtracted.
  kRaw = 7,            ///< The low byte of the converter's result is sent, for tests.
};

[[nodiscard]] constexpr std::uint32_t can_id(std::uint32_t message_class, std::uint8_t source,
                                             std::uint8_t destination) {
  return message_class | static_cast<std::uint32_t>(source & 0xF) << 4 | (destination & 0xFU);
}

/// Returns true if the node address can belong to an iCub board. With a higher address, the frames would look like
/// those of another board.
[[nodiscard]] constexpr bool is_board(std::uint8_t node_address) {
  return node_address >= 1 && node_address <= kMaxBoard;
}

/// Identifier FD30 carries the state of the controller's iCub protocol.
struct State {
  static constexpr std::uint16_t kId = did::kIcub;
  static constexpr std::size_t kMinBytes = 9, kMaxBytes = 9;
  static constexpr std::uint8_t kNoBoard = 1, kOffsetRefused = 2, kAddressRefused = 4, kCommandRefused = 8;
  static constexpr std::uint8_t kAllFlags = 15;
  std::uint8_t flags = 0;
  std::uint8_t last_refused = 0;  ///< The field holds the last command that was refused; 0 means none so far.
  std::uint8_t refused = 0;       ///< The count of refused commands starts at power-up and stops at 255.
  std::uint8_t skin_type = 0, period_ms = 0, no_load = 0, shift = 0;  ///< The shift belongs to triangle 0.
  std::uint16_t enabled = 0;                                          ///< Bit t enables triangle t.

  /// Appends the value in its wire format (docs/protocol.md). `out` is no longer ok() if it lacks room.
  constexpr void encode(ByteWriter& out) const {
    for (const std::uint8_t b : {flags, last_refused, refused, skin_type, period_ms, no_load, shift}) out.u8(b);
    out.le16(enabled);
  }
  /// Decodes the wire format. Errors: kBadLength, kOutOfRange (a flag that does not exist).
  [[nodiscard]] static constexpr Result<State> decode(Bytes bytes) {
    if (bytes.size() != kMaxBytes) return std::unexpected(Status::kBadLength);
    ByteReader r(bytes);
    State s;
    for (std::uint8_t* b : {&s.flags, &s.last_refused, &s.refused, &s.skin_type, &s.period_ms, &s.no_load, &s.shift})
      *b = r.u8();
    s.enabled = r.le16();
    if (s.flags > kAllFlags) return std::unexpected(Status::kOutOfRange);
    return s;
  }
  bool operator==(const State&) const = default;
};
static_assert(kLengthsAsInTable<State>);

}  // namespace triskin::wire::icub
