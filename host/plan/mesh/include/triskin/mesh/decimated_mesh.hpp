// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <optional>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {

/// By default the mesh of the solvers may be this far from the surface that it stands for.
inline constexpr double kSolverDeviation_mm = 0.05;
/// By default its borders may be off by this much: the overhang of modules over a border is measured to 0.02 mm.
inline constexpr double kSolverBorder_mm = 0.01;

/// Stands for a surface with more faces than the solvers need: their cost follows the area and the shape, not the
/// number of faces. Its corners are corners of the surface; parts, holes and handles are the same.
struct DecimatedMesh {
  Mesh mesh;
  /// No point of either mesh is farther from the other. The bound is proved, but for rounding (1e-9 mm per step), and
  /// never exceeds what the caller asked for.
  double deviation_mm = 0.0;
  double border_mm = 0.0;  ///< No border moved farther than this.
};

/// Removes corners while the bounds hold, at the flattest places first. An edge is collapsed if the faces around a
/// corner and those that replace them cover each other one to one, seen along their mean normal; the distance between
/// them along it is added to the bound of the new faces. Sharp edges, bends and borders stay where the bounds need
/// them, and so do corners where several borders meet. Faces of the result may be nearer to each other than those of
/// the surface, by at most twice the deviation. Errors: none; with a deviation of 0 nothing is removed. The bound of
/// the deviation grows in steps, each four times the one before; with `enough_faces` no further step begins once no
/// more faces than that are left. Deterministic, whatever the number of threads. Uses `threads` (≥ 1); thread-safe.
/// Cost: O(n), 2 … 3 µs of processor time per removed face, 60 bytes per face.
[[nodiscard]] DecimatedMesh decimate(const Surface& surface, double deviation_mm = kSolverDeviation_mm,
                                     double border_mm = kSolverBorder_mm, int threads = 2,
                                     std::size_t enough_faces = 0);

/// Returns the mesh for the solvers with these limits if the surface has more faces than they need. Returns nothing if
/// the surface itself is suitable: fewer than 5,000 faces or more than 4 mm² per face on average, `deviation_mm` <= 0,
/// or more than half of the faces would remain. With a narrow limit of lift, depth, centre gap or overrun the deviation
/// is smaller than asked for: a twentieth of that limit. Cost: that of decimate(), or nothing.
[[nodiscard]] std::optional<DecimatedMesh> solver_mesh_of(const Surface& surface, const LayoutLimits& limits,
                                                          double deviation_mm = kSolverDeviation_mm, int threads = 2);

/// Returns the limits that a module must keep on the solver's mesh so that it keeps the given ones on the surface:
/// lift, depth and centre gap less the deviation, overrun less that of the border; at least half of each.
[[nodiscard]] LayoutLimits limits_on(const DecimatedMesh& solver, LayoutLimits limits);

}  // namespace triskin::mesh
