// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "checked_design.hpp"

namespace triskin::check {

/// An edge of a flat outline. All decisions here are exact.
struct FlatEdge {
  P2 a, b;
};

/// Adds the edges of an open ring.
void add_ring(const std::vector<P2>& ring, std::vector<FlatEdge>& edges);

/// Returns true if the interiors of the edges cross in one point.
[[nodiscard]] bool do_cross(const FlatEdge& one, const FlatEdge& other);

/// Returns true if q lies inside the rings (even–odd rule); on an edge either answer.
[[nodiscard]] bool is_inside(const P2& q, const std::vector<FlatEdge>& edges);

/// Returns true if the edge does not enter the interior of the convex counter-clockwise polygon `t`.
[[nodiscard]] bool is_free_of(const std::vector<P2>& t, const FlatEdge& e);

/// Returns true if the interiors of two convex counter-clockwise polygons have no point in common.
[[nodiscard]] bool are_apart(const std::vector<P2>& s, const std::vector<P2>& t);

}  // namespace triskin::check
