// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::design {

/// Returns the line, from 1, in which the value at `place` ("modules[3].corners") begins in the JSON `text`; if the
/// place is missing, it is the line of the innermost part that exists. Cost: linear.
[[nodiscard]] std::size_t line_of(const std::string& text, const std::string& place);

/// JSON value with its place ("modules[3].corners"), so that every error names file and key. It refers to `value`,
/// which must outlive it. Every reading function throws InputError "file: place: what is wrong"; constant cost.
class JsonValue {
 public:
  /// `place` is empty at the top level. `text` is what `value` was parsed from and must outlive this object; if it is
  /// given, errors also name the line ("file:12: place: what is wrong").
  JsonValue(const nlohmann::json& value, std::string file, std::string place, const std::string* text = nullptr)
      : value_(value), file_(std::move(file)), place_(std::move(place)), text_(text) {}

  /// Throws InputError with file, place and `what`.
  [[noreturn]] void fail(const std::string& what) const { fail_at(place_, what); }
  /// Throws InputError for an object and names the line of its key `key`.
  [[noreturn]] void fail_at_key(const std::string& key, const std::string& what) const { fail_at(below(key), what); }
  /// Returns the place as messages name it.
  [[nodiscard]] const std::string& place() const { return place_; }
  /// Returns a member of an object; throws InputError for other types and missing keys.
  [[nodiscard]] JsonValue operator[](const char* key) const {
    if (!value_.is_object()) fail("must be an object");
    const auto found = value_.find(key);
    if (found == value_.end()) fail(fmt::format("key \"{}\" is missing", key));
    return {*found, file_, below(key), text_};
  }
  /// Returns an element of an array, 0-based; throws InputError for other types and beyond the end.
  [[nodiscard]] JsonValue at(std::size_t index) const {
    if (!value_.is_array() || index >= value_.size()) fail(fmt::format("must be an array with an element {}", index));
    return {value_[index], file_, fmt::format("{}[{}]", place_, index), text_};
  }
  /// Returns the number of elements of an array; throws InputError for other types.
  [[nodiscard]] std::size_t size() const {
    if (!value_.is_array()) fail("must be an array");
    return value_.size();
  }
  /// Throws InputError unless the value is an array of n elements.
  void require_size(std::size_t n) const {
    if (size() != n) fail(fmt::format("must have {} elements, has {}", n, size()));
  }
  /// Returns a finite number; throws InputError for other types, infinities and NaN.
  [[nodiscard]] double number() const {
    if (!value_.is_number()) fail("must be a number");
    const double x = value_.get<double>();
    if (!std::isfinite(x)) fail("must be finite");
    return x;
  }
  /// Returns an integer in [low, high]; throws InputError for other types and values.
  [[nodiscard]] int integer(int low, int high) const {
    if (!value_.is_number_integer()) fail("must be an integer");
    const bool huge = value_.is_number_unsigned() && value_.get<std::uint64_t>() > 0x7FFFFFFFU;
    const auto x = huge ? std::int64_t{0x7FFFFFFF} : value_.get<std::int64_t>();
    if (huge || x < low || x > high) fail(fmt::format("must be in {} … {}", low, high));
    return static_cast<int>(x);
  }
  /// Returns an integer in 0 … 2⁶⁴ − 1; throws InputError for other types and values.
  [[nodiscard]] std::uint64_t unsigned_integer() const {
    if (!value_.is_number_unsigned()) fail("must be a whole number that is not negative");
    return value_.get<std::uint64_t>();
  }
  /// Returns true or false; throws InputError for other types.
  [[nodiscard]] bool boolean() const {
    if (!value_.is_boolean()) fail("must be true or false");
    return value_.get<bool>();
  }
  /// Returns a text; throws InputError for other types.
  [[nodiscard]] std::string text() const;
  /// Returns the underlying value without any check.
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

/// Parses JSON text. Errors: InputError naming `file` and the place for text that is not JSON or is nested more than 64
/// deep (the parser is recursive). Cost: linear.
[[nodiscard]] nlohmann::json parse_json(const std::string& text, const std::string& file);

/// Requires that the key "format" of a file is `wanted`. Errors: InputError that names both, at this key.
void require_format(const JsonValue& v, std::string_view wanted);

/// Returns true if `v` is an object with `key`. Constant cost.
[[nodiscard]] inline bool has(const JsonValue& v, const char* key) {
  return v.raw().is_object() && v.raw().contains(key);
}

/// Counts in a file may not be larger; the limit exceeds any design and still fits into an int.
inline constexpr int kMaxCount = 10'000'000;

}  // namespace triskin::design
