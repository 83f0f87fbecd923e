// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/off_rest.hpp"

#include <fmt/format.h>

#include "triskin/base/counted.hpp"
#include "triskin/base/short_list.hpp"

namespace triskin::design {

std::string sentence(const OffRest& off) {
  if (off.taxels == 0) return {};
  return fmt::format("{} {} not rest: tare; {} {}: {}", counted(off.taxels, "taxel"),
                     agreeing(off.taxels, "does", "do"), agreeing(off.taxels, "its", "their"),
                     noun_after(off.modules.size() == 1, "module"), short_list(off.modules));
}

}  // namespace triskin::design
