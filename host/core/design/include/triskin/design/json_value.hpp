// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace triskin::design {

/// Parses JSON text: the one reader of JSON in the program (the checker has its own). Errors: InputError naming `file`
/// and line for text that is not JSON or has a number that no double holds; naming the path for a key that appears
/// twice in one object, of which the library would drop one, and for more than 64 levels (its parser recurses). Cost:
/// linear.
[[nodiscard]] nlohmann::json parse_json(const std::string& text, const std::string& file);

/// JSON value with its path as of RFC 6901 ("/modules/3/corners"), so that every error names file and path. It refers
/// to `value`, which must outlive it. Every reading function throws InputError "file: path: what is wrong"; constant
/// cost.
class JsonValue {
 public:
  /// `path` is empty at the top level.
  JsonValue(const nlohmann::json& value, std::string file, std::string path = "")
      : value_(value), file_(std::move(file)), path_(std::move(path)) {}

  /// Throws InputError with file, path and `what`.
  [[noreturn]] void fail(const std::string& what) const;
  /// The same for the member `key` of this object.
  [[noreturn]] void fail_at_key(const std::string& key, const std::string& what) const;
  /// The path as messages name it.
  [[nodiscard]] const std::string& path() const { return path_; }
  /// A member of an object; throws for other types and missing keys.
  [[nodiscard]] JsonValue operator[](const char* key) const;
  /// An element of an array, 0-based; throws for other types and beyond the end.
  [[nodiscard]] JsonValue at(std::size_t index) const;
  /// The number of elements of an array; throws for other types.
  [[nodiscard]] std::size_t size() const;
  /// Throws unless the value is an array of n elements.
  void require_size(std::size_t n) const;
  /// A finite number; throws for other types and infinities.
  [[nodiscard]] double number() const;
  /// An integer in [low, high]; throws for other types and values.
  [[nodiscard]] int integer(int low, int high) const;
  /// An integer in 0 … 2⁶⁴ − 1; throws for other types and values.
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  /// True or false; throws for other types.
  [[nodiscard]] bool boolean() const;
  /// A text; throws for other types.
  [[nodiscard]] std::string text() const;
  /// The underlying value without any check.
  [[nodiscard]] const nlohmann::json& raw() const { return value_; }

 private:
  [[nodiscard]] std::string below(std::string_view key) const;

  const nlohmann::json& value_;
  std::string file_;
  std::string path_;
};

/// Returns true if `v` is an object with `key`. Constant cost.
[[nodiscard]] bool has(const JsonValue& v, const char* key);

/// Counts in a file may not be larger; the limit exceeds any design and still fits into an int.
inline constexpr int kMaxCount = 10'000'000;

}  // namespace triskin::design
