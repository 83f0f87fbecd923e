// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/json_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/json_cause.hpp"

namespace triskin::design {
namespace {

constexpr std::size_t kMaxLevels = 64;

// A key of a path: RFC 6901 writes ~ as ~0 and / as ~1.
std::string escaped(std::string_view key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

// Reads a text without storing its values, and refuses what the library's parser would take or not survive.
class Examiner : public nlohmann::json_sax<nlohmann::json> {
 public:
  Examiner(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  bool null() override { return value(); }
  bool boolean(bool /*value*/) override { return value(); }
  bool number_integer(std::int64_t /*value*/) override { return value(); }
  bool number_unsigned(std::uint64_t /*value*/) override { return value(); }
  bool number_float(double /*value*/, const std::string& /*token*/) override { return value(); }
  bool string(std::string& /*value*/) override { return value(); }
  bool binary(nlohmann::json::binary_t& /*value*/) override { return value(); }
  bool start_object(std::size_t /*elements*/) override { return open(); }
  bool start_array(std::size_t /*elements*/) override { return open(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(std::string& name) override {
    if (!open_.back().keys.insert(name).second)
      throw InputError(
          fmt::format("{}: {}: key \"{}\" appears twice in one object; leave one out", file_, path(), name));
    open_.back().step = escaped(name);
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::json::exception& error) override {
    const std::size_t first = text_.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) throw InputError(fmt::format("{}: is not JSON: it is empty", file_));
    if (text_[first] != '{' && text_[first] != '[') {
      auto kind = file_kind(text_);
      if (!kind) kind = part_kind(text_);
      if (kind) throw InputError(fmt::format("{}: is {}, where a file in JSON is wanted", file_, kind->what));
    }
    constexpr int kNumberOverflow = 406;  // the only error of which the library's message names no line
    if (error.id != kNumberOverflow)
      throw InputError(fmt::format("{}: is not JSON: {}", file_, json_cause(error.what())));
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    throw InputError(fmt::format("{}: is not JSON: line {}: {}", file_, 1 + std::count(text_.begin(), end, '\n'),
                                 json_cause(error.what())));
  }

 private:
  struct Open {
    std::set<std::string> keys;
    std::string step;  ///< last key, or number of the last element
    int elements = 0;
  };

  bool value() {
    if (!open_.empty() && open_.back().keys.empty()) open_.back().step = std::to_string(open_.back().elements++);
    return true;
  }
  bool open() {
    value();
    if (open_.size() == kMaxLevels) throw InputError(fmt::format("{}: nested deeper than {}", file_, kMaxLevels));
    open_.emplace_back();
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  [[nodiscard]] std::string path() const {
    if (open_.size() == 1) return "top level";
    std::string all;
    for (std::size_t k = 0; k + 1 < open_.size(); ++k) all += '/' + open_[k].step;
    return all;
  }

  const std::string& text_;
  const std::string& file_;
  std::vector<Open> open_;
};

}  // namespace

nlohmann::json parse_json(const std::string& text, const std::string& file) {
  Examiner examiner(text, file);
  (void)nlohmann::json::sax_parse(text, &examiner);
  return nlohmann::json::parse(text);
}

void JsonValue::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}: {}", file_, path_.empty() ? "top level" : path_, what));
}

void JsonValue::fail_at_key(const std::string& key, const std::string& what) const {
  JsonValue(value_, file_, below(key)).fail(what);
}

JsonValue JsonValue::operator[](const char* key) const {
  if (!value_.is_object()) fail("must be an object");
  const auto found = value_.find(key);
  if (found == value_.end()) fail(fmt::format("key \"{}\" is missing", key));
  return {*found, file_, below(key)};
}

JsonValue JsonValue::at(std::size_t index) const {
  if (!value_.is_array() || index >= value_.size()) fail(fmt::format("must be an array with an element {}", index));
  return {value_[index], file_, below(std::to_string(index))};
}

std::size_t JsonValue::size() const {
  if (!value_.is_array()) fail("must be an array");
  return value_.size();
}

void JsonValue::require_size(std::size_t n) const {
  if (size() != n) fail(fmt::format("must have {} elements, has {}", n, size()));
}

double JsonValue::number() const {
  if (!value_.is_number()) fail("must be a number");
  const double x = value_.get<double>();
  if (!std::isfinite(x)) fail("must be finite");
  return x;
}

int JsonValue::integer(int low, int high) const {
  if (!value_.is_number_integer()) fail("must be an integer");
  const bool huge = value_.is_number_unsigned() && value_.get<std::uint64_t>() > 0x7FFFFFFFU;
  const auto x = huge ? std::int64_t{0x7FFFFFFF} : value_.get<std::int64_t>();
  if (huge || x < low || x > high) fail(fmt::format("must be in {} … {}", low, high));
  return static_cast<int>(x);
}

std::uint64_t JsonValue::unsigned_integer() const {
  if (!value_.is_number_unsigned()) fail("must be a whole number that is not negative");
  return value_.get<std::uint64_t>();
}

bool JsonValue::boolean() const {
  if (!value_.is_boolean()) fail("must be true or false");
  return value_.get<bool>();
}

std::string JsonValue::text() const {
  if (!value_.is_string()) fail("must be a text");
  return value_.get<std::string>();
}

std::string JsonValue::below(std::string_view key) const {
  return fmt::format("{}/{}", path_, escaped(key));
}

bool has(const JsonValue& v, const char* key) {
  return v.raw().is_object() && v.raw().contains(key);
}

}  // namespace triskin::design
