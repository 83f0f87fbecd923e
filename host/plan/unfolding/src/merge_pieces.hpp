// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "cut_surface.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::unfolding {

/// Lays the faces (sorted) flat as one piece; returns nothing when that breaks a limit.
using TryPiece = std::function<std::optional<Piece>(const std::vector<FaceIndex>& faces)>;

/// Joins pieces again across sides that are not cut, longest seam first, if the joined piece keeps the limits. The
/// number of faces laid flat on the way is bounded (30 times those of the surface, at least 60,000), so a dirty mesh of
/// thousands of pieces ends too.
void merge_pieces(const CutSurface& cut, std::vector<Piece>& pieces, const TryPiece& try_piece,
                  const ProgressSink& progress);

}  // namespace triskin::unfolding
