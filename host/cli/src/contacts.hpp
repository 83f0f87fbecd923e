// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/jobs/touch_map.hpp"
#include "triskin/recording/messages.hpp"

namespace triskin::cli {

/// The taxels under pressure as messages have them.
inline std::vector<recording::Contact> contacts_of(const device::TouchMap& touches) {
  std::vector<recording::Contact> contacts;
  for (const auto& t : touches.pressed())
    contacts.push_back({t.module, t.taxel, t.change_counts, t.position_mm, t.normal});
  return contacts;
}

}  // namespace triskin::cli
