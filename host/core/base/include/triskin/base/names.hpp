// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace triskin {

/// The single table that gives each value of an enumeration its name in files, reports and options.
template <class Enum, std::size_t kCount>
class NameTable {
 public:
  /// Takes one row per value; names and values must each be unique.
  constexpr explicit NameTable(std::array<std::pair<Enum, std::string_view>, kCount> rows) : rows_(rows) {}

  /// Returns the name of a value; empty when the table lacks it. Cost: one comparison per row.
  [[nodiscard]] constexpr std::string_view name(Enum value) const {
    for (const auto& [v, n] : rows_) {
      if (v == value) return n;
    }
    return {};
  }
  /// Returns the value of a name, upper and lower case as in the table; nullopt when it is unknown.
  [[nodiscard]] constexpr std::optional<Enum> value(std::string_view name) const {
    for (const auto& [v, n] : rows_) {
      if (n == name) return v;
    }
    return std::nullopt;
  }
  /// Lists all names for a message: "a, b or c".
  [[nodiscard]] std::string list() const {
    std::string text;
    for (std::size_t k = 0; k < kCount; ++k) {
      if (k > 0) text += k + 1 == kCount ? " or " : ", ";
      text += rows_[k].second;
    }
    return text;
  }
  /// Returns all rows (value, name) in the order of the table.
  [[nodiscard]] constexpr const auto& rows() const { return rows_; }

 private:
  std::array<std::pair<Enum, std::string_view>, kCount> rows_;
};

template <class Enum, std::size_t kCount>
NameTable(std::array<std::pair<Enum, std::string_view>, kCount>) -> NameTable<Enum, kCount>;

}  // namespace triskin
