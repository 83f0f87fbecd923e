// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/jobs/touch_map.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::device {

void TouchMap::add(const ModuleFrame& frame) {
  Module& m = modules_[static_cast<std::size_t>(frame.module)];
  for (std::size_t t = 0; t < frame.sample.value.size(); ++t) {
    const bool valid = (frame.sample.valid >> t & 1) != 0;
    if (valid && m.seen[t] < kRestSamples) {
      m.first[t][m.seen[t]++] = frame.sample.value[t];
      if (m.seen[t] == kRestSamples) {
        std::ranges::sort(m.first[t]);
        m.rest[t] = m.first[t][kRestSamples / 2];
      }
    }
    m.now[t] = valid && m.seen[t] == kRestSamples ? frame.sample.value[t]
                                                  : m.rest[t];  // an invalid or new taxel is unknown, not pressed
  }
}

std::vector<PressedTaxel> TouchMap::pressed() const {
  std::vector<PressedTaxel> pressed;
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    std::array<design::TaxelPose, layout::kTaxelsPerModule> poses;
    bool posed = false;
    for (std::size_t t = 0; t < modules_[k].now.size(); ++t) {
      const double change = std::abs(modules_[k].now[t] - modules_[k].rest[t]);
      if (change < kPressed_counts) continue;
      if (!posed) poses = design::taxels_of(design_.layout.modules[k], wiring_[k].routed.rotation);
      posed = true;
      pressed.push_back({static_cast<int>(k), static_cast<int>(t), change, poses[t].position_mm, poses[t].normal});
    }
  }
  std::ranges::sort(pressed, std::greater{}, &PressedTaxel::change_counts);
  return pressed;
}

}  // namespace triskin::device
