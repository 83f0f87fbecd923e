// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/can_frame.hpp"

/// Commands that iCub hosts send to a skin board on 11-bit identifiers: class << 8 | source << 4 | destination.
/// docs/protocol.md, "iCub commands". Taxels themselves are in taxel_frames.hpp.
namespace triskin::wire::icub {

inline constexpr std::uint32_t kPollingClass = 0x200, kLoaderClass = 0x700, kClassMask = 0x700;
inline constexpr std::uint8_t kEverybody = 0xF;
inline constexpr std::uint8_t kMaxBoard = 14;  ///< a controller with a higher node address is no iCub board

inline constexpr std::uint8_t kSetTransmission = 0x07;  ///< data 1: 0 starts, anything else stops
inline constexpr std::uint8_t kSetupObsolete = 0x4C;    ///< starts too
inline constexpr std::uint8_t kSetBoard = 0x4D;         ///< skin type, period in ms, value at rest
inline constexpr std::uint8_t kSetTriangles = 0x50;     ///< first, last, shift, bit 0 enabled, 16-bit offset
inline constexpr std::uint8_t kDiscover = 0xFF;         ///< in the loader class; answered with type and version

inline constexpr std::uint8_t kBoardType = 11;  ///< MTB4

[[nodiscard]] constexpr std::uint32_t can_id(std::uint32_t message_class, std::uint8_t source,
                                             std::uint8_t destination) {
  return message_class | static_cast<std::uint32_t>(source & 0xF) << 4 | (destination & 0xFU);
}

}  // namespace triskin::wire::icub
