// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

namespace triskin {

/// Returns the items for a message, "3, 7, 12 and 69 more": it names at most `most` of them and counts the others.
template <typename Items>
[[nodiscard]] std::string short_list(const Items& items, std::size_t most = 12) {
  const std::span all(items);
  const std::string named = fmt::format("{}", fmt::join(all.first(std::min(most, all.size())), ", "));
  return all.size() <= most ? named : fmt::format("{} and {} more", named, all.size() - most);
}

}  // namespace triskin
