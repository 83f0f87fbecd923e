// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::geometry {

/// Unfolded surface.
struct Net {
  std::vector<Piece> pieces;
  int overlaps = 0;  ///< pairs of flat triangles of one piece that overlap; 0 in a valid net
};

/// Options of unfold().
struct UnfoldingOptions {
  double edge_error_mm = 1.0;        ///< > 0: largest edge error of a piece, for an edge of 30 mm
  int iterations = 60;               ///< ≥ 1, of the local/global flattening (Liu et al., 2008)
  int darts = 3;                     ///< ≥ 0: most cuts from the border into a piece before it is divided instead
  std::function<bool()> give_up{};   ///< asked between steps; true: what is divided so far is not joined further
  std::vector<SurfaceEdge> seams{};  ///< cut open, whether needed or not
  std::vector<SurfaceEdge> uncut{};  ///< never cut: their two faces stay in one piece, joined
};

/// Unfolds a surface into flat pieces at true scale: flattens (as rigid as possible), and while a piece has a larger
/// edge error, darts it from the border where that suffices and is shorter than dividing, else divides it in two; a
/// flipped triangle or an outline that crosses itself always divides. Ends always: single triangles are flat.
/// Afterwards pieces are joined again while the limits hold. Where `give_up` says so before the division is complete,
/// the net has no piece; after that the pieces stay as they are. Deterministic; one thread; thread-safe. Cost: about
/// O(n log n) per level of division. Errors: InputError when an edge is in both lists, or when faces that must stay
/// joined cannot be laid flat within the limit. Source: docs/unfolding.md.
[[nodiscard]] Net unfold(const Surface& surface, const UnfoldingOptions& options = {},
                         const ProgressSink& progress = {});

}  // namespace triskin::geometry
