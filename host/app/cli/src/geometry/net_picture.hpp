// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::cli {

/// Draws the net as SVG, 1 user unit = 1 mm: pieces side by side, each triangle coloured by its edge error (white 0,
/// red at `limit_mm`), outlines black, with a bar of 100 mm.
[[nodiscard]] std::string net_svg(const mesh::Surface& surface, const unfolding::Net& net, double limit_mm);

}  // namespace triskin::cli
