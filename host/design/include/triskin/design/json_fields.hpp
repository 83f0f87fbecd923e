// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "triskin/design/json_value.hpp"
#include "triskin/design/mesh.hpp"

/// Fields that several formats of ours have. Each throws InputError "file: place: what is wrong"; constant cost.
namespace triskin::design {

/// Number written as 16 hexadecimal digits.
[[nodiscard]] inline std::uint64_t hex64(const JsonValue& v) {
  const std::string text = v.text();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + 16) v.fail("must be 16 hexadecimal digits");
  return value;
}

/// Largest coordinate or length of a file. A double still resolves 2 µm there, and no micrometre that a design id has
/// in it leaves 64 bits.
inline constexpr double kMaxLength_mm = 1e10;

/// Number in [low, high], in the unit of the field.
[[nodiscard]] inline double number_in(const JsonValue& v, double low, double high) {
  const double x = v.number();
  if (x < low || x > high) v.fail(fmt::format("must be in {:g} … {:g}", low, high));
  return x;
}

/// Three numbers of at most kMaxLength_mm.
[[nodiscard]] inline Vec3 vec3(const JsonValue& v) {
  const auto one = [&v](std::size_t axis) { return number_in(v.at(axis), -kMaxLength_mm, kMaxLength_mm); };
  v.require_size(3);
  return {one(0), one(1), one(2)};
}

/// Throws unless `v` is an object with keys of `allowed` only: a misspelt key would silently change nothing. `page`
/// describes the format, for the message.
inline void only_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed, std::string_view page) {
  if (!v.raw().is_object()) v.fail("must be an object");
  for (const auto& [key, value] : v.raw().items()) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
      v.fail_at_key(key, fmt::format("key \"{}\" is unknown here; see {}", key, page));
  }
}

}  // namespace triskin::design
