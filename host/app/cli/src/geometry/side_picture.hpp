// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/mesh/side.hpp"

namespace triskin::cli {

/// Draws the part from four directions as SVG: outer faces green, inner ones red, rims grey, and the two undecided
/// sides orange with the number 1 and blue with the number 2.
[[nodiscard]] std::string side_svg(const design::Mesh& part, const mesh::SideChoice& choice);

}  // namespace triskin::cli
