// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/off_rest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>

#include "triskin/base/counted.hpp"

namespace triskin::design {

std::string sentence(const OffRest& off) {
  constexpr std::size_t kMaxNamed = 12;
  if (off.taxels == 0) return {};
  const std::span modules(off.modules);
  const std::size_t named = std::min(kMaxNamed, modules.size());
  const std::string more = named < modules.size() ? fmt::format(" and {} more", modules.size() - named) : "";
  return fmt::format("{} {} not rest: tare; {} {}: {}{}", counted(off.taxels, "taxel"),
                     agreeing(off.taxels, "does", "do"), agreeing(off.taxels, "its", "their"),
                     noun_after(modules.size() == 1, "module"), fmt::join(modules.first(named), ", "), more);
}

}  // namespace triskin::design
