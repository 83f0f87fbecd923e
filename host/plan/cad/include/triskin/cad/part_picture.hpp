// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/cad/part.hpp"

namespace triskin::cad {

/// Draws a part from the front and from behind as SVG (two isometric views): each face in its own colour with its
/// index, faces outside `selected` grey; an empty list selects all. Names in it are escaped. Cost: O(n log n).
[[nodiscard]] std::string part_svg(const Part& part, const std::vector<design::BrepFaceIndex>& selected = {});

}  // namespace triskin::cad
