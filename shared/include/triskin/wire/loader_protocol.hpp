// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

/// The loader's CAN protocol uses classic frames with 29-bit identifiers. FROZEN: loaders in the field are never
/// replaced, so nothing here may change; new functions belong to the application's UDS. docs/flash_layout.md has the
/// sequence of an update.
namespace triskin::wire::loader {

inline constexpr std::uint8_t kProtocol = 1;
/// The host sends a command and its arguments to the loader.
inline constexpr std::uint32_t kRequestId = 0x1BF10000;
/// The host sends eight bytes of the image at a time, in order.
inline constexpr std::uint32_t kDataId = 0x1BF20000;
/// The loader answers with the command, a Status and the data that the command asks for.
inline constexpr std::uint32_t kReplyId = 0x1BF30000;

enum class Command : std::uint8_t {
  /// The reply is protocol, state of slots 0 and 1 (bit 0 valid, 1 confirmed, 2 startable) and CRC-32 of the unique id
  /// (LE); the loader then stays active.
  kHello = 1,
  kSelect = 2,  ///< The argument is the CRC-32 of a unique id; only that controller obeys from now on.
  /// The argument is the slot; erasing takes up to 3 s. The slot that would start now is refused with kWrongTarget.
  kErase = 3,
  /// The loader sends this only as a reply, after every 32 data frames: status, offset of the next byte (LE).
  kData = 4,
  kCommit = 5,  ///< The arguments are the size (3 bytes LE) and CRC-32 of the image (LE).
  kBoot = 6,    ///< The loader starts the newest slot.
};
/// Converts a number from the wire; empty if there is no such command.
[[nodiscard]] constexpr std::optional<Command> to_command(std::uint8_t number) {
  if (number < static_cast<std::uint8_t>(Command::kHello) || number > static_cast<std::uint8_t>(Command::kBoot))
    return std::nullopt;
  return static_cast<Command>(number);
}
inline constexpr std::uint32_t kFramesPerReply = 32;
inline constexpr std::uint64_t kWindow_us = 20'000;  ///< After a reset the loader waits this long for kHello.

}  // namespace triskin::wire::loader
