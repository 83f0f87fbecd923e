// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "paper/side_marks.hpp"

namespace triskin::placement::paper {

/// Rejects every module with a vertex of the polygon deeper inside than the touching distance, and every module that a
/// hole fills to its sides. Cost: O(vertices).
void reject_pierced(const GridFrame& frame, SideMarks& marks);

}  // namespace triskin::placement::paper
