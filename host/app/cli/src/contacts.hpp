// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/skin/skin_contacts.hpp"

namespace triskin::cli {

/// Converts contacts to messages, with forces if `calibration` is complete.
inline std::vector<recording::Contact> contact_messages(const skin::TouchMap& touches, const design::Design& design,
                                                        const design::SkinCalibration& calibration) {
  std::vector<recording::Contact> messages;
  for (const skin::SkinContact& c : skin::contacts_of(touches, design, calibration)) {
    recording::Contact& m = messages.emplace_back();
    m.position_mm = c.position_mm;
    m.normal = c.normal;
    m.change_counts = c.change_counts;
    m.force_n = std::isfinite(c.force_n) ? c.force_n : 0.0;
    m.area_mm2 = c.area_mm2;
    for (const skin::PressedTaxel& t : c.taxels) {
      const double force_n = calibration.complete() ? calibration.force_n({t.module, t.taxel}, t.change_counts) : 0.0;
      m.taxels.push_back({t.module, t.taxel, t.change_counts, t.position_mm, t.normal, force_n});
    }
  }
  return messages;
}

}  // namespace triskin::cli
