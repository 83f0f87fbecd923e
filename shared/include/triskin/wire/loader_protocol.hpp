// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

/// What the loader speaks on CAN: classic frames, 29-bit identifiers. FROZEN: loaders in the field are never replaced,
/// so nothing here changes; new functions go into the application's UDS. docs/firmware_images.md has the sequence of an
/// update.
namespace triskin::wire::loader {

inline constexpr std::uint8_t kProtocol = 1;
inline constexpr std::uint32_t kRequestId = 0x1BF10000;  ///< host → loader: command, arguments
inline constexpr std::uint32_t kDataId = 0x1BF20000;     ///< host → loader: eight bytes of the image, in order
inline constexpr std::uint32_t kReplyId = 0x1BF30000;    ///< loader → host: command, Status, …

enum class Command : std::uint8_t {
  kHello = 1,  ///< reply: protocol, state of slot 0 and 1 (bit 0 valid, 1 confirmed, 2 startable), CRC-32 of the unique
               ///< id (LE); stays in the loader
  kSelect = 2,  ///< CRC-32 of the unique id: from now on only this controller obeys
  kErase = 3,   ///< slot; takes up to 3 s. kWrongTarget for the slot that would start now
  kData = 4,    ///< only in replies: after each 32 data frames: status, offset of the next byte (LE)
  kCommit = 5,  ///< size (3 bytes LE), CRC-32 of the image (LE)
  kBoot = 6,    ///< starts the newest slot
};
/// The command of a number from the wire; empty: no command.
[[nodiscard]] constexpr std::optional<Command> to_command(std::uint8_t number) {
  if (number < static_cast<std::uint8_t>(Command::kHello) || number > static_cast<std::uint8_t>(Command::kBoot))
    return std::nullopt;
  return static_cast<Command>(number);
}
inline constexpr std::uint32_t kFramesPerReply = 32;
inline constexpr std::uint64_t kWindow_us = 20'000;  ///< the loader waits this long for kHello after a reset

}  // namespace triskin::wire::loader
