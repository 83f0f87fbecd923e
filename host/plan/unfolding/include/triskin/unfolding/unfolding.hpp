// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::unfolding {

struct Net {
  std::vector<Piece> pieces;
  int overlaps = 0;  ///< Pairs of flat triangles of one piece may overlap; a valid net has none.
};

struct UnfoldingOptions {
  /// No edge of a piece may be off by more than this, scaled to an edge of 30 mm; must be positive.
  double edge_error_mm = 1.0;
  int iterations = 60;  ///< The local/global flattening (Liu et al., 2008) takes at least one.
  int darts = 3;        ///< A piece gets at most this many cuts from its border; after that it is split instead.
  /// unfold() asks this between steps; once it returns true, the pieces so far are not joined any more.
  std::function<bool()> give_up{};
  std::vector<SurfaceEdge> seams{};  ///< These edges are always cut open, even if the shape does not need it.
  std::vector<SurfaceEdge> uncut{};  ///< These edges are never cut, so their two faces stay joined in one piece.
};

/// Unfolds a surface into flat pieces at true scale. Flattens each piece (as rigid as possible); if its edge error is
/// too large, adds a seam from the border if that is enough and shorter, otherwise splits the piece in two. A flipped
/// triangle or an outline that crosses itself always splits. It always terminates, because single triangles are flat.
/// Afterwards pieces are joined again while the limits hold. If `give_up` returns true before the division is complete,
/// the net has no piece; after that the pieces stay as they are. Deterministic; one thread; thread-safe. Cost: about
/// O(n log n) per level of division. Errors: InputError when an edge is in both lists, or when faces that must stay
/// joined cannot be laid flat within the limit. Source: docs/unfolding.md.
[[nodiscard]] Net unfold(const mesh::Surface& surface, const UnfoldingOptions& options = {},
                         const ProgressSink& progress = {});

}  // namespace triskin::unfolding
