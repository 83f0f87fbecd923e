// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <vector>

#include "silhouette.hpp"

namespace triskin::fabrication {

/// Lays each island, in this order, on the first sheet of `width` × `height` pixels that has room for it, as low as it
/// goes in any turn, and then as far to the left. Every island must fit an empty sheet in one of its turns. The places
/// are in the order of the islands. Cost: about 0.05 s for 14 islands of 150 modules on a sheet of 300 × 400 mm.
[[nodiscard]] std::vector<PixelPlace> bottom_left(const Silhouettes& silhouettes, const std::vector<std::size_t>& order,
                                                  int width, int height);

}  // namespace triskin::fabrication
