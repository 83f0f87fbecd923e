// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// SVG of a part from in front and from behind (two isometric views): each face in a colour of its own with its index,
/// what is not in `selected` grey; an empty list selects all. Names in it are escaped. Cost: O(n log n).
[[nodiscard]] std::string part_svg(const Part& part, const std::vector<int>& selected = {});

}  // namespace triskin::cad
