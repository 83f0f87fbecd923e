// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "checked_design.hpp"
#include "triskin/base/error.hpp"

/// Values of a JSON file with their paths, so that each error names the place. The checker shares no reader with what
/// it checks, so it has its own. Each function throws InputError "path: what is wrong"; constant cost.
namespace triskin::check::json_path {

using nlohmann::json;

/// A double still resolves 2 µm there, and no micrometre in a design id exceeds 64 bits.
inline constexpr double kMaxNumber = 1e10;

/// The value as it stands there, cut to 40 bytes.
[[nodiscard]] std::string shown(const json& j);
/// The path for a message.
[[nodiscard]] std::string place(const std::string& path);

/// A value of the file and its place there, as /modules/3/id. Its functions throw InputError that names the place.
class Value {
 public:
  Value(const json& value, std::string path) : value_(&value), path_(std::move(path)) {}
  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", place(path_), what)); }
  [[nodiscard]] const json& raw() const { return *value_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool contains(const char* key) const { return value_->contains(key); }
  [[nodiscard]] Value at(const char* key) const {
    if (!value_->is_object()) fail(fmt::format("must be an object, is {}", shown(*value_)));
    const auto found = value_->find(key);
    if (found == value_->end())
      fail(fmt::format("key \"{}\" is missing; make the design again with triskin design", key));
    return {*found, path_ + '/' + key};
  }
  [[nodiscard]] std::size_t size() const {
    if (!value_->is_array()) fail(fmt::format("must be a list, is {}", shown(*value_)));
    return value_->size();
  }
  [[nodiscard]] Value item(std::size_t k) const { return {value_->at(k), path_ + '/' + std::to_string(k)}; }
  [[nodiscard]] std::string text() const {
    if (!value_->is_string()) fail(fmt::format("must be a text, is {}", shown(*value_)));
    return value_->get<std::string>();
  }
  [[nodiscard]] bool boolean() const {
    if (!value_->is_boolean()) fail(fmt::format("must be true or false, is {}", shown(*value_)));
    return value_->get<bool>();
  }

 private:
  const json* value_;
  std::string path_;
};

/// A number in ±kMaxNumber. JSON converts a number to any requested type, whether it fits or not.
[[nodiscard]] double number(const Value& v);
/// A whole number in ±10,000,000.
[[nodiscard]] int integer(const Value& v);
[[nodiscard]] int bounded(const Value& v, int low, int high);
/// A number of 16 hexadecimal digits.
[[nodiscard]] std::uint64_t hex_id(const Value& v);
[[nodiscard]] P2 p2(const Value& v);
[[nodiscard]] P3 p3(const Value& v);

/// Reads the index of an element of a list of `n`.
[[nodiscard]] inline auto index_below(std::size_t n) {
  return [n](const Value& v) { return bounded(v, 0, static_cast<int>(n) - 1); };
}
/// A list of another length is wrong, whatever its beginning is.
inline const Value& list_of(const Value& v, std::size_t n) {
  if (v.size() != n) v.fail(fmt::format("must be a list of {}, has {}", n, v.size()));
  return v;
}
template <class Read>
[[nodiscard]] auto all(const Value& v, Read read) {
  std::vector<decltype(read(v))> out;
  for (std::size_t k = 0; k < v.size(); ++k) out.push_back(read(v.item(k)));
  return out;
}
template <class Read>
[[nodiscard]] auto three_of(const Value& v, Read read) {
  list_of(v, 3);
  return std::array{read(v.item(0)), read(v.item(1)), read(v.item(2))};
}

}  // namespace triskin::check::json_path
