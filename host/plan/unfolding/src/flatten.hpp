// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "cut_surface.hpp"

namespace triskin::unfolding {

/// A connected set of faces with its own vertices, laid flat.
struct FlatChart {
  std::vector<FaceIndex> faces;  ///< The numbers are those of the surface.
  /// The indices refer to `flat`, in the order of the corners on the surface.
  std::vector<std::array<int, 3>> local_faces;
  std::vector<VertexIndex> vertices;  ///< Each local vertex has its vertex on the surface.
  std::vector<Vec2> flat;             ///< Positions are in mm.
};

/// Lays the faces flat, joined unless cut, each as rigid as possible: starts from an unfolding along the shortest dual
/// paths from the middle face, then alternates best rotations and one prefactored sparse solve (Sorkine and Alexa,
/// 2007; Liu et al., 2008). The sum of squares leaves its largest error at the border (on a spherical cap
/// a·K·ρ²/8); if that is above but near `limit_mm`, faces are weighted by their error (Lawson, 1961) until the
/// largest error is evened out (a·K·ρ²/12). Stops early when the limit is out of reach. Cost: `iterations` sparse
/// solves, and some 40 more with 8 factorizations when weighting; stops between solves when `give_up` returns true.
[[nodiscard]] FlatChart flatten(const CutSurface& cut, const std::vector<FaceIndex>& faces, int iterations,
                                double limit_mm, const std::function<bool()>& give_up = {});

/// Gives the largest and root mean square |flat − surface| length of an edge, scaled to an edge of 30 mm.
struct EdgeError {
  double max_mm = 0.0, rms_mm = 0.0;
};
[[nodiscard]] EdgeError edge_error(const mesh::Surface& surface, const FlatChart& chart);

/// Returns true when a flat triangle is turned over or has no area.
[[nodiscard]] bool has_flip(const FlatChart& chart);

/// Returns the border loops of the chart as local vertices; the longest comes first.
[[nodiscard]] std::vector<std::vector<int>> chart_loops(const FlatChart& chart);

}  // namespace triskin::unfolding
