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

/// Readers of fields that occur in several of our formats. Each throws InputError "file: place: what is wrong";
/// constant cost.
namespace triskin::design {

/// Reads a number of 16 hexadecimal digits.
[[nodiscard]] inline std::uint64_t hex64(const JsonValue& v) {
  const std::string text = v.text();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + 16) v.fail("must be 16 hexadecimal digits");
  return value;
}

/// Coordinates and lengths in a file may not be larger. At this size a double still resolves 2 µm, and lengths in
/// micrometres, as the design id uses them, fit into 64 bits.
inline constexpr double kMaxLength_mm = 1e10;

/// Reads a number in [low, high], in the unit of the field.
[[nodiscard]] inline double number_in(const JsonValue& v, double low, double high) {
  const double x = v.number();
  if (x < low || x > high) v.fail(fmt::format("must be in {:g} … {:g}", low, high));
  return x;
}

/// Reads three numbers, each at most kMaxLength_mm in size.
[[nodiscard]] inline Vec3 vec3(const JsonValue& v) {
  const auto one = [&v](std::size_t axis) { return number_in(v.at(axis), -kMaxLength_mm, kMaxLength_mm); };
  v.require_size(3);
  return {one(0), one(1), one(2)};
}

/// Throws unless `v` is an object that has only keys of `allowed`, because a misspelt key would silently have no
/// effect. The message names `page`, which describes the format.
inline void only_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed, std::string_view page) {
  if (!v.raw().is_object()) v.fail("must be an object");
  for (const auto& [key, value] : v.raw().items()) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
      v.fail_at_key(key, fmt::format("key \"{}\" is unknown here; see {}", key, page));
  }
}

}  // namespace triskin::design
