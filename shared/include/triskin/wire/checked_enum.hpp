// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <type_traits>

#include "triskin/core/status.hpp"

namespace triskin::wire {

/// Converts a number from the wire into an enumerator; all code uses this function for it. The enumeration must begin
/// with 0 and have no gaps; `last` is its greatest value. Error: kOutOfRange.
template <class Enum>
  requires std::is_enum_v<Enum>
[[nodiscard]] constexpr Result<Enum> checked_enum(std::uint8_t number, Enum last) {
  if (number > static_cast<std::uint8_t>(last)) return std::unexpected(Status::kOutOfRange);
  return static_cast<Enum>(number);
}

/// Returns the number that represents an enumerator on the wire.
template <class Enum>
  requires std::is_enum_v<Enum>
[[nodiscard]] constexpr std::uint8_t wire_number(Enum value) {
  return static_cast<std::uint8_t>(value);
}

/// Converts a truth value that travels as 1 or 0. Error: kOutOfRange.
[[nodiscard]] constexpr Result<bool> checked_bool(std::uint8_t number) {
  if (number > 1) return std::unexpected(Status::kOutOfRange);
  return number == 1;
}

/// Converts a number from the wire. Error: kOutOfRange.
[[nodiscard]] constexpr Result<Status> to_status(std::uint8_t number) {
  return checked_enum(number, Status::kUnproven);
}

}  // namespace triskin::wire
