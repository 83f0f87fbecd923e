// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/core.h>

#include <concepts>

namespace triskin {

/// Describes layout::Index and nothing else: a class that is an integer of one kind, with −1 for none. This part does
/// not include the class, because only host/core/base may be used everywhere on the host. An index of modules is
/// excluded: what people read is the number of a module (design::number_of).
template <class T>
concept IndexKind = requires(const T index) {
  typename T::value_type;
  requires std::integral<typename T::value_type>;
  { index.value() } -> std::same_as<typename T::value_type>;
  { T::none() } -> std::same_as<T>;
  requires std::convertible_to<T, typename T::value_type>;
} && !requires { typename T::tag_type::HasNumber; };

}  // namespace triskin

/// Formats an index as its integer, with the same format specifications.
template <triskin::IndexKind T>
struct fmt::formatter<T, char> : fmt::formatter<typename T::value_type> {};
