// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::exports {

/// Draws the changes between two designs as SVG, from the side that shows most modules: unchanged modules grey, new
/// ones green with their number, and the outlines of removed ones red. `new_id` is indexed by module of `old`, with
/// −1 for removed ones; `added` has ids in `now`. Errors: std::out_of_range for an id that a design lacks. Cost:
/// O(faces + modules).
[[nodiscard]] std::string revision_svg(const design::Design& old, const design::Design& now,
                                       const std::vector<int>& new_id, const std::vector<int>& added);

}  // namespace triskin::exports
