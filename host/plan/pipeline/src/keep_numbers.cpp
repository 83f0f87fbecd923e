// SPDX-License-Identifier: GPL-3.0-or-later
#include "keep_numbers.hpp"

#include <algorithm>

#include "triskin/base/index.hpp"

namespace triskin::pipeline {

void keep_numbers(design::ModuleLayout& layout, std::vector<int>& new_id, std::span<int> added) {
  const std::size_t count = layout.modules.size();
  std::vector<int> number(count, -1);  // The index is the present id.
  std::vector<bool> is_taken(count, false);
  for (std::size_t was = 0; was < std::min(count, new_id.size()); ++was) {
    if (new_id[was] < 0) continue;
    number[at(new_id[was])] = static_cast<int>(was);
    is_taken[was] = true;
  }
  std::size_t free = 0;
  const auto give_free_number = [&](int id) {
    while (is_taken[free]) ++free;
    number[at(id)] = static_cast<int>(free);
    is_taken[free] = true;
  };
  for (const int id : added) give_free_number(id);
  for (std::size_t id = 0; id < count; ++id) {
    if (number[id] < 0) give_free_number(static_cast<int>(id));
  }
  std::vector<design::PlacedModule> modules(count);
  for (std::size_t id = 0; id < count; ++id) {
    design::PlacedModule& m = modules[at(number[id])] = layout.modules[id];
    for (int& n : m.neighbour) n = n < 0 ? -1 : number[at(n)];
  }
  layout.modules = std::move(modules);
  for (int& id : new_id) id = id < 0 ? -1 : number[at(id)];
  for (int& id : added) id = number[at(id)];
}

}  // namespace triskin::pipeline
