// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "checked_design.hpp"

namespace triskin::check {

/// The points are in order and lie in one plane.
using Outline3 = std::vector<P3>;

/// Returns the part of a module that corner cuts of `cut` mm along each side leave, with every side also drawn in by
/// `inset` mm: the triangle moved in and clipped by the three lines of the cuts. Empty when nothing remains. Without a
/// cut the result is the triangle.
[[nodiscard]] Outline3 module_outline(const Triangle3& corners, double cut, double inset = 0.0);

/// Returns the part of a convex outline with direction · (p - from) <= limit (Sutherland and Hodgman), including
/// points on the line.
[[nodiscard]] Outline3 clipped(const Outline3& outline, const P3& from, const P3& direction, double limit = 0.0);

/// Returns how far a point lies beyond the line of the nearest cut, mm; negative inside. `cut` must be positive.
[[nodiscard]] double beyond_cut(const Triangle3& corners, double cut, const P3& point);

/// Returns the area of a module after the cuts, mm².
[[nodiscard]] double area_left(double cut);

}  // namespace triskin::check
