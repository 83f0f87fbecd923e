// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Picture of what changed from one design to the next (SVG), from the side that shows most modules: those that stayed
/// grey, new ones green with their number, and the outlines of those that went red. `new_id`: by module of `old`, −1:
/// gone; `added`: ids in `now`. Errors: std::out_of_range for an id that a design lacks. Cost: O(faces + modules).
[[nodiscard]] std::string revision_svg(const Design& old, const Design& now, const std::vector<int>& new_id,
                                       const std::vector<int>& added);

}  // namespace triskin::design
