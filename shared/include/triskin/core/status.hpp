// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <expected>

namespace triskin {

/// The reason why a request was refused. The numbers travel on the wire and are never reused.
enum class Status : std::uint8_t {
  kOk = 0,            ///< The request was carried out.
  kTooShort = 1,      ///< There are fewer bytes than the format needs.
  kBadMagic = 2,      ///< The first bytes are not those of the format.
  kBadVersion = 3,    ///< The layout version is not the reader's own.
  kBadLength = 4,     ///< The stated length differs from the number of bytes given.
  kBadCrc = 5,        ///< The checksum differs from that of the bytes.
  kOutOfRange = 6,    ///< A field exceeds its limit.
  kDuplicate = 7,     ///< Two rows share a line and address, or a module id.
  kBadTree = 8,       ///< A parent is missing, the rows form a cycle, or there is more than one entry.
  kWrongTarget = 9,   ///< The table is for another controller, or the firmware for another slot or hardware.
  kFlashFailed = 10,  ///< Erasing or programming was refused, or the flash reads back differently.
  kEmpty = 11,        ///< Nothing has been stored here yet.
  kNoSpace = 12,      ///< The content is larger than the buffer or slot.
  kBusError = 13,     ///< No chip acknowledged on the I²C line.
  kLineStuck = 14,    ///< SDA or SCL of the I²C line is held low.
  kWrongId = 15,      ///< The chip answers with the device id of another type.
  kOlder = 16,        ///< The firmware offered is older than the one that runs.
  kUnproven = 17,     ///< The firmware that runs has not confirmed itself yet, so it must not be replaced.
};

template <class T>
using Result = std::expected<T, Status>;

}  // namespace triskin
