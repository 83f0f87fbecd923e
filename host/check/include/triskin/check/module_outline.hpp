// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/check/checked_design.hpp"

namespace triskin::check {

/// Points in order, in one plane.
using Outline3 = std::vector<P3>;

/// What corner cuts of `cut` mm along each side leave of a module, every side drawn in by `inset` mm besides: the
/// triangle moved in and clipped by the three lines of the cuts. Empty when nothing is left. Without a cut: the
/// triangle.
[[nodiscard]] Outline3 module_outline(const Triangle3& corners, double cut, double inset = 0.0);

/// The part of a convex outline with direction · (p - from) <= limit (Sutherland and Hodgman); points on the line are
/// in it.
[[nodiscard]] Outline3 clipped(const Outline3& outline, const P3& from, const P3& direction, double limit = 0.0);

/// How far a point lies beyond the line of the nearest cut, mm; negative inside. `cut` > 0.
[[nodiscard]] double beyond_cut(const Triangle3& corners, double cut, const P3& point);

/// Area that the cuts leave of a module, mm².
[[nodiscard]] double area_left(double cut);

}  // namespace triskin::check
