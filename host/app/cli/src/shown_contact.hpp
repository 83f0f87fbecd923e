// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/skin/skin_contacts.hpp"
#include "triskin/view/latest_samples.hpp"

namespace triskin::cli {

/// Returns a contact of a cover as the page shows it. `first_module` is the number of the cover's first module on the
/// page; the position stays in the frame of the cover.
inline view::LatestSamples::Contact shown_contact(const skin::SkinContact& c, layout::SkinModule first_module) {
  view::LatestSamples::Contact shown{.taxels = {},
                                     .position_mm = c.position_mm,
                                     .position_sd_mm = c.position_sd_mm,
                                     .force_n = c.force_n,
                                     .force_sd_n = c.force_sd_n,
                                     .area_mm2 = c.area_mm2,
                                     .change_counts = c.change_counts};
  for (const skin::PressedTaxel& t : c.taxels)
    shown.taxels.push_back(layout::kTaxelsPerModule * (first_module + t.module) + t.taxel);
  return shown;
}

}  // namespace triskin::cli
