// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/json_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string>

namespace triskin::design {

std::uint64_t hex64(const JsonValue& v) {
  const std::string text = v.text();
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.size() != 16 || error != std::errc{} || end != text.data() + 16) v.fail("must be 16 hexadecimal digits");
  return value;
}

double number_in(const JsonValue& v, double low, double high) {
  const double x = v.number();
  if (x < low || x > high) v.fail(fmt::format("must be in {:g} … {:g}", low, high));
  return x;
}

Vec3 vec3(const JsonValue& v) {
  const auto one = [&v](std::size_t axis) { return number_in(v.at(axis), -kMaxLength_mm, kMaxLength_mm); };
  v.require_size(3);
  return {one(0), one(1), one(2)};
}

void only_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed, std::string_view page) {
  if (!v.raw().is_object()) v.fail("must be an object");
  for (const auto& [key, value] : v.raw().items()) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end())
      v.fail_at_key(key, fmt::format("key \"{}\" is unknown here; see {}", key, page));
  }
}

}  // namespace triskin::design
