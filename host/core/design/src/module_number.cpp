// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/module_number.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "triskin/base/error.hpp"

namespace triskin::design {

ModuleNumber number_of(const ModuleLayout& layout, int id) {
  if (id < 0 || layout.numbers.empty()) return {id};
  return {layout.numbers.at(static_cast<std::size_t>(id))};
}

ModuleNumber number_of(const Design& design, int id) {
  return number_of(design.layout, id);
}

const NamedCover* cover_of(const Design& design, int id) {
  const NamedCover* cover = nullptr;
  for (const NamedCover& c : design.covers) {
    if (c.first.module.value() <= id) cover = &c;
  }
  return cover;
}

layout::ModuleId module_with(const ModuleLayout& layout, ModuleNumber number) {
  const auto count = static_cast<int>(layout.modules.size());
  if (layout.numbers.empty())
    return number.value < 0 || number.value >= count ? layout::ModuleId::none() : layout::ModuleId{number.value};
  const auto found = std::ranges::lower_bound(layout.numbers, number.value);
  if (found == layout.numbers.end() || *found != number.value) return layout::ModuleId::none();
  return layout::ModuleId{found - layout.numbers.begin()};
}

layout::ModuleId module_with(const Design& design, ModuleNumber number) {
  return module_with(design.layout, number);
}

layout::ModuleId require_module(const Design& design, ModuleNumber number) {
  const layout::ModuleId id = module_with(design, number);
  if (id < 0) {
    throw InputError(
        fmt::format("there is no module {}; the design has {}", number.value, ranges_text(all_numbers(design.layout))));
  }
  return id;
}

std::string jumper_name(const Design& design, const Jumper& jumper) {
  return fmt::format("J{}-{}", number_of(design, jumper.node[0]), number_of(design, jumper.node[1]));
}

std::vector<int> all_numbers(const ModuleLayout& layout) {
  if (!layout.numbers.empty()) return layout.numbers;
  std::vector<int> numbers(layout.modules.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

void set_numbers(ModuleLayout& layout, std::vector<int> numbers) {
  const bool has_gaps = !numbers.empty() && numbers.back() != static_cast<int>(numbers.size()) - 1;
  layout.numbers = has_gaps ? std::move(numbers) : std::vector<int>{};
}

int next_number(const Design& design) {
  const auto count = static_cast<int>(design.layout.modules.size());
  const int above_last = count == 0 ? 0 : number_of(design, count - 1).value + 1;
  return std::max(design.next_number, above_last);
}

void require_fitting_number(const Design& design, int number) {
  const bool has_kinds = !design.kinds.empty();
  const int max = has_kinds ? kMaxModuleNumberWithKinds : kMaxModuleNumber;
  const std::size_t modules = design.layout.modules.size();
  if (number > max && modules > static_cast<std::size_t>(max) + 1) {
    throw InputError(fmt::format(
        "A design has at most {} modules{}, this one {}: divide the part, one design for each piece{}", max + 1,
        has_kinds ? " where there are kinds" : "", modules, has_kinds ? ", or leave the kinds out" : ""));
  }
  if (number > max) {
    throw InputError(
        fmt::format("The numbers of modules end at {}{}, and those of modules that are gone are not given again; make "
                    "the design anew with triskin design",
                    max, has_kinds ? " where there are kinds" : ""));
  }
}

std::string ranges_text(std::span<const int> numbers) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t last = k;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += text.empty() ? "" : ",";
    text += last == k ? fmt::format("{}", numbers[k]) : fmt::format("{}-{}", numbers[k], numbers[last]);
    k = last + 1;
  }
  return text;
}

}  // namespace triskin::design
