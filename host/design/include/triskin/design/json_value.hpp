// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::design {

/// Line, from 1, in which the value at `place` ("modules[3].corners") begins in `text`, which is JSON; where the text
/// lacks the place, the line of the part of it that is there. Cost: linear.
[[nodiscard]] std::size_t line_of(const std::string& text, const std::string& place);

/// JSON value with its place ("modules[3].corners"), so that every error names file and key. Refers to `value`, which
/// must outlive it. Every function that reads throws InputError "file: place: what is wrong"; constant cost.
class JsonValue {
 public:
  /// `place` is empty at the top level. `text`: what `value` was parsed from; it outlives this object, and errors then
  /// name the line, too ("file:12: place: what is wrong").
  JsonValue(const nlohmann::json& value, std::string file, std::string place, const std::string* text = nullptr)
      : value_(value), file_(std::move(file)), place_(std::move(place)), text_(text) {}

  /// Throws InputError with file, place and `what`.
  [[noreturn]] void fail(const std::string& what) const { fail_at(place_, what); }
  /// The same for an object; the line is that of its key `key`.
  [[noreturn]] void fail_at_key(const std::string& key, const std::string& what) const { fail_at(below(key), what); }
  /// The place, as messages name it.
  [[nodiscard]] const std::string& place() const { return place_; }
  /// Member of an object; throws InputError on other types and where the key is missing.
  [[nodiscard]] JsonValue operator[](const char* key) const {
    if (!value_.is_object()) fail("must be an object");
    const auto found = value_.find(key);
    if (found == value_.end()) fail(fmt::format("key \"{}\" is missing", key));
    return {*found, file_, below(key), text_};
  }
  /// Element of an array, 0-based; throws InputError on other types and beyond the end.
  [[nodiscard]] JsonValue at(std::size_t index) const {
    if (!value_.is_array() || index >= value_.size()) fail(fmt::format("must be an array with an element {}", index));
    return {value_[index], file_, fmt::format("{}[{}]", place_, index), text_};
  }
  /// Number of elements; throws InputError on all but arrays.
  [[nodiscard]] std::size_t size() const {
    if (!value_.is_array()) fail("must be an array");
    return value_.size();
  }
  /// Throws InputError unless the value is an array of n elements.
  void require_size(std::size_t n) const {
    if (size() != n) fail(fmt::format("must have {} elements, has {}", n, size()));
  }
  /// Finite number; throws InputError on other types, infinities and NaN.
  [[nodiscard]] double number() const {
    if (!value_.is_number()) fail("must be a number");
    const double x = value_.get<double>();
    if (!std::isfinite(x)) fail("must be finite");
    return x;
  }
  /// Integer in [low, high]; throws InputError on other types and values.
  [[nodiscard]] int integer(int low, int high) const {
    if (!value_.is_number_integer()) fail("must be an integer");
    const bool huge = value_.is_number_unsigned() && value_.get<std::uint64_t>() > 0x7FFFFFFFU;
    const auto x = huge ? std::int64_t{0x7FFFFFFF} : value_.get<std::int64_t>();
    if (huge || x < low || x > high) fail(fmt::format("must be in {} … {}", low, high));
    return static_cast<int>(x);
  }
  /// Integer in 0 … 2⁶⁴ − 1; throws InputError on other types and values.
  [[nodiscard]] std::uint64_t unsigned_integer() const {
    if (!value_.is_number_unsigned()) fail("must be a whole number that is not negative");
    return value_.get<std::uint64_t>();
  }
  /// true or false; throws InputError on other types.
  [[nodiscard]] bool boolean() const {
    if (!value_.is_boolean()) fail("must be true or false");
    return value_.get<bool>();
  }
  /// Text; throws InputError on other types.
  [[nodiscard]] std::string text() const {
    if (!value_.is_string()) fail("must be a text");
    return value_.get<std::string>();
  }
  /// The value itself, unchecked.
  [[nodiscard]] const nlohmann::json& raw() const { return value_; }

 private:
  [[nodiscard]] std::string below(const std::string& key) const {
    return place_.empty() ? key : fmt::format("{}.{}", place_, key);
  }
  [[noreturn]] void fail_at(const std::string& line_place, const std::string& what) const {
    const std::string line = text_ != nullptr ? fmt::format(":{}", line_of(*text_, line_place)) : "";
    throw InputError(fmt::format("{}{}: {}: {}", file_, line, place_.empty() ? "top level" : place_, what));
  }

  const nlohmann::json& value_;
  std::string file_;
  std::string place_;
  const std::string* text_;
};

/// Parses JSON text. Errors: InputError naming `file` and the place for text that is not JSON or nests deeper than 64
/// (the parser recurses). Cost: linear.
[[nodiscard]] nlohmann::json parse_json(const std::string& text, const std::string& file);

/// True if `v` is an object with `key`. Constant cost.
[[nodiscard]] inline bool has(const JsonValue& v, const char* key) {
  return v.raw().is_object() && v.raw().contains(key);
}

/// Largest count that a file may name: beyond any design, safely inside int.
inline constexpr int kMaxCount = 10'000'000;

}  // namespace triskin::design
