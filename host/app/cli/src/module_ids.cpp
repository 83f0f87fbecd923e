// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_ids.hpp"

#include <fmt/format.h>

#include <charconv>
#include <set>
#include <sstream>
#include <string_view>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::cli {
namespace {

constexpr int kMaxNumber = 9'999'999;

// Parses a whole number in [low, kMaxNumber]; the text may contain nothing else.
bool read_number(std::string_view text, int low, int& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && number >= low && number <= kMaxNumber;
}

}  // namespace

std::vector<layout::ModuleId> modules_named(const design::Design& design, const std::string& option,
                                            const std::string& text) {
  std::vector<layout::ModuleId> ids;
  std::set<int> missing;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-', 1);
    const std::string_view whole = part;
    int first = 0, last = 0;
    bool is_read = read_number(whole.substr(0, dash), 0, first);
    last = first;
    if (dash != std::string::npos) is_read = is_read && read_number(whole.substr(dash + 1), first, last);
    if (!is_read) {
      throw InputError(
          fmt::format("{}: \"{}\" is not understood; give modules and ranges of them, as 3,7-9", option, part));
    }
    const layout::ModuleId begin = design::module_with(design, {first}), end = design::module_with(design, {last});
    for (layout::ModuleId id = begin; begin >= 0 && id <= end; ++id) ids.push_back(id);
    for (int number = first; (begin < 0 || end < 0) && number <= last; ++number) {
      if (design::module_with(design, {number}) < 0) missing.insert(number);
    }
  }
  if (!missing.empty()) {
    throw InputError(fmt::format("{}: there {} {}; the design has {}", option,
                                 missing.size() == 1 ? "is no module" : "are no modules",
                                 design::ranges_text(std::vector(missing.begin(), missing.end())),
                                 design::ranges_text(design::all_numbers(design.layout))));
  }
  return ids;
}

std::string modules_text(const design::Design& design, std::span<const layout::ModuleId> ids) {
  std::vector<int> numbers;
  for (const layout::ModuleId id : ids) numbers.push_back(design::number_of(design, id).value);
  return design::ranges_text(numbers);
}

}  // namespace triskin::cli
