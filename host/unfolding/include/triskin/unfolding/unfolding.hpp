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
  int overlaps = 0;  ///< Pairs of flat triangles of one piece may overlap; a valid net has none.
};

/// Options of unfold().
struct UnfoldingOptions {
  double edge_error_mm = 1.0;  ///< It is the largest edge error of a piece for an edge of 30 mm, > 0.
  int iterations = 60;         ///< The local/global flattening (Liu et al., 2008) takes at least one.
  int darts = 3;               ///< A piece gets at most so many cuts from its border before it is divided instead.
  /// It is asked between steps; after it returns true, what is divided so far is not joined further.
  std::function<bool()> give_up{};
  std::vector<SurfaceEdge> seams{};  ///< They are cut open whether needed or not.
  std::vector<SurfaceEdge> uncut{};  ///< They are never cut, so their two faces stay joined in one piece.
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
