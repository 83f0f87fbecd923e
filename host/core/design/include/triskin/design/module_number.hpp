// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include <compare>
#include <concepts>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"

/// A module has an id, by which lists are indexed, and a number, which people read: on its label and wherever a program
/// or a file names it. A module keeps its number when a design is changed, so numbers can have gaps where ids have none
/// (docs/design_file.md). Only numbers can be formatted and written to JSON.
namespace triskin::design {

/// It converts to no integer, so that nothing is indexed by it.
struct ModuleNumber {
  int value = -1;  ///< 0 … kMaxModuleNumber; −1: no module
  [[nodiscard]] friend bool operator==(const ModuleNumber&, const ModuleNumber&) = default;
  [[nodiscard]] friend auto operator<=>(const ModuleNumber&, const ModuleNumber&) = default;
  [[nodiscard]] friend bool operator==(const ModuleNumber& number, int integer) { return number.value == integer; }
};

/// The table of a controller has 16 bits for a number, of which three are the kind's where there are kinds.
inline constexpr int kMaxModuleNumber = 0xFFFF, kMaxModuleNumberWithKinds = 0x1FFF;

/// Returns the number of module `id`, which is one of this layout, or −1 for −1.
/// Constant cost.
[[nodiscard]] ModuleNumber number_of(const ModuleLayout& layout, int id);
[[nodiscard]] ModuleNumber number_of(const Design& design, int id);

/// Returns the cover of a joint design that module `id` belongs to, or null for a design of one cover. Cost: O(covers).
[[nodiscard]] const NamedCover* cover_of(const Design& design, int id);

/// Returns the module with this number, or −1. Cost: O(log n).
[[nodiscard]] layout::ModuleId module_with(const ModuleLayout& layout, ModuleNumber number);
[[nodiscard]] layout::ModuleId module_with(const Design& design, ModuleNumber number);

/// Returns the same and throws InputError "there is no module 7; …" with the numbers that there are.
[[nodiscard]] layout::ModuleId require_module(const Design& design, ModuleNumber number);

/// Returns the numbers of these modules, in their order.
template <typename Ids>
[[nodiscard]] std::vector<ModuleNumber> numbers_of(const Design& design, const Ids& ids) {
  std::vector<ModuleNumber> numbers;
  for (const auto& id : ids) numbers.push_back(number_of(design, id));
  return numbers;
}

/// Returns the name of a jumper on labels and in all outputs, "J4-17": the numbers of its modules, so that it keeps its
/// name as long as they keep theirs. Constant cost.
[[nodiscard]] std::string jumper_name(const Design& design, const Jumper& jumper);

/// Returns the numbers of all modules, ascending. Cost: O(n).
[[nodiscard]] std::vector<int> all_numbers(const ModuleLayout& layout);
/// Gives the modules these ascending numbers, as many as there are modules.
void set_numbers(ModuleLayout& layout, std::vector<int> numbers);

/// Returns the number that the next module gets: above all that modules of this design have or once had.
[[nodiscard]] int next_number(const Design& design);

/// Throws InputError, which says the remedy, if the tables of this design have no room for this number.
void require_fitting_number(const Design& design, int number);

/// Writes ascending numbers as ranges, "3,7-9".
[[nodiscard]] std::string ranges_text(std::span<const int> numbers);

/// nlohmann::json finds this function.
template <class Json>
  requires std::constructible_from<Json, int>
void to_json(Json& json, ModuleNumber number) {
  json = number.value;
}

}  // namespace triskin::design

/// Formats a number as its integer, with the same format specifications.
template <>
struct fmt::formatter<triskin::design::ModuleNumber, char> : fmt::formatter<int> {
  template <class Context>
  auto format(triskin::design::ModuleNumber number, Context& context) const {
    return fmt::formatter<int>::format(number.value, context);
  }
};
