// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace triskin {

/// The one table that gives each value of an enumeration the name under which files, reports and options know it.
template <class Enum, std::size_t kCount>
class NameTable {
 public:
  /// One row a value; names and values must each be unique.
  constexpr explicit NameTable(std::array<std::pair<Enum, std::string_view>, kCount> rows) : rows_(rows) {}

  /// Name of a value; empty when the table lacks it. Cost: one comparison a row.
  [[nodiscard]] constexpr std::string_view name(Enum value) const {
    for (const auto& [v, n] : rows_) {
      if (v == value) return n;
    }
    return {};
  }
  /// Value of a name, upper and lower case as in the table; nullopt when it is unknown.
  [[nodiscard]] constexpr std::optional<Enum> value(std::string_view name) const {
    for (const auto& [v, n] : rows_) {
      if (n == name) return v;
    }
    return std::nullopt;
  }
  /// All names for a message: "a, b or c".
  [[nodiscard]] std::string list() const {
    std::string text;
    for (std::size_t k = 0; k < kCount; ++k) {
      if (k > 0) text += k + 1 == kCount ? " or " : ", ";
      text += rows_[k].second;
    }
    return text;
  }
  /// All rows in the order of the table: value, name.
  [[nodiscard]] constexpr const auto& rows() const { return rows_; }

 private:
  std::array<std::pair<Enum, std::string_view>, kCount> rows_;
};

template <class Enum, std::size_t kCount>
NameTable(std::array<std::pair<Enum, std::string_view>, kCount>) -> NameTable<Enum, kCount>;

}  // namespace triskin
