// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/recording/messages.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::cli {

/// Returns the contacts on a cover in the form of messages, with forces if `calibration` is complete.
inline std::vector<recording::Contact> contacts_of(const device::TouchMap& touches, const design::Design& design,
                                                   const design::SkinCalibration& calibration) {
  std::vector<recording::PressedTaxel> taxels;
  for (const auto& t : touches.pressed()) {
    const double force_n = calibration.complete() ? calibration.force_n(t.module, t.taxel, t.change_counts) : 0.0;
    taxels.push_back({t.module, t.taxel, t.change_counts, t.position_mm, t.normal, force_n});
  }
  return recording::gather_contacts(taxels, design::module_area_mm2(design.layout.corner_cut_mm));
}

}  // namespace triskin::cli
