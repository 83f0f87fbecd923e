// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <expected>

namespace triskin {

/// Why something was refused. The numbers travel on the wire and are never reused.
enum class Status : std::uint8_t {
  kOk = 0,            ///< in order
  kTooShort = 1,      ///< fewer bytes than the format needs
  kBadMagic = 2,      ///< other first bytes than the format has
  kBadVersion = 3,    ///< another layout version
  kBadLength = 4,     ///< stated length differs from the bytes given
  kBadCrc = 5,        ///< the checksum differs
  kOutOfRange = 6,    ///< a field beyond its limit
  kDuplicate = 7,     ///< line and address, or a module id, stands twice
  kBadTree = 8,       ///< parent missing, cycle, or more than one entry
  kWrongTarget = 9,   ///< a table for another controller, firmware for another slot or hardware
  kFlashFailed = 10,  ///< erase or program was refused, or read back differs
  kEmpty = 11,        ///< nothing stored
  kNoSpace = 12,      ///< larger than the buffer or slot
  kBusError = 13,     ///< I²C: no acknowledgement
  kLineStuck = 14,    ///< I²C: SDA or SCL held low
  kWrongId = 15,      ///< chip answers with another device id
  kOlder = 16,        ///< firmware older than the one that runs
  kUnproven = 17,     ///< the firmware that runs has not confirmed itself yet
};

template <class T>
using Result = std::expected<T, Status>;

}  // namespace triskin
