// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>

namespace triskin {

/// Returns an English noun in the form that follows a number: as it is given after 1, else its plural ("taxels",
/// "patches", "bodies", "vertices"). `noun`: its singular, of one or several words, of which the last changes.
/// Threads: any.
[[nodiscard]] std::string noun_after(bool is_one, std::string_view noun);

/// Returns a number with its noun, as "1 taxel" or "3 patches". Every message that counts things uses it.
template <std::integral Number>
[[nodiscard]] std::string counted(Number number, std::string_view noun) {
  return fmt::format("{} {}", number, noun_after(number == 1, noun));
}

/// Returns the form of a verb or pronoun that goes with a number: `one` with 1, else `many`.
template <std::integral Number>
[[nodiscard]] constexpr std::string_view agreeing(Number number, std::string_view one, std::string_view many) {
  return number == 1 ? one : many;
}

}  // namespace triskin
