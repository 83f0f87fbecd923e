// SPDX-License-Identifier: GPL-3.0-or-later
#include "json_path.hpp"

#include <charconv>
#include <cmath>

namespace triskin::check::json_path {

constexpr int kMaxCount = 10'000'000;

std::string shown(const json& j) {
  return j.dump().substr(0, 40);
}

std::string place(const std::string& path) {
  return path.empty() ? "top level" : path;
}

double number(const Value& v) {
  if (!v.raw().is_number()) v.fail(fmt::format("must be a number, is {}", shown(v.raw())));
  const double value = v.raw().get<double>();
  if (!(std::abs(value) <= kMaxNumber)) v.fail(fmt::format("must lie in ±{:g}, is {}", kMaxNumber, shown(v.raw())));
  return value;
}

int integer(const Value& v) {
  const json& j = v.raw();
  if (!j.is_number_integer()) v.fail(fmt::format("must be a whole number, is {}", shown(j)));
  const bool fits = j.is_number_unsigned() ? j.get<std::uint64_t>() <= std::uint64_t{kMaxCount}
                                           : j.get<std::int64_t>() >= -std::int64_t{kMaxCount};
  if (!fits) v.fail(fmt::format("must lie in ±{}, is {}", kMaxCount, shown(j)));
  return j.get<int>();
}

int bounded(const Value& v, int low, int high) {
  const int value = integer(v);
  if (value < low || value > high) v.fail(fmt::format("must lie in {} … {}, is {}", low, high, value));
  return value;
}

std::uint64_t hex_id(const Value& v) {
  const std::string text = v.text();
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id, 16);
  if (error != std::errc{} || end != text.data() + text.size())
    v.fail(fmt::format("must be 16 hexadecimal digits, is {}", shown(v.raw())));
  return id;
}

P2 p2(const Value& v) {
  list_of(v, 2);
  return {number(v.item(0)), number(v.item(1))};
}

P3 p3(const Value& v) {
  list_of(v, 3);
  return {number(v.item(0)), number(v.item(1)), number(v.item(2))};
}

}  // namespace triskin::check::json_path
