// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::exports {

/// A board on an iCub bus always counts sixteen triangles, even if fewer exist, and fourteen boards can have an iCub
/// stream.
inline constexpr int kIcubTriangles = 16, kIcubBoards = 14;
/// skinGui cannot draw more triangles.
inline constexpr int kSkinGuiTriangles = 128;

/// Returns the number of a module among the triangles of a part in the host's order: 16 * patch + 4 · line + address.
/// Its taxel t is value 12 · number + t of the part's port.
[[nodiscard]] constexpr int icub_triangle(const design::ModuleWiring& wiring) {
  return kIcubTriangles * wiring.patch + 4 * wiring.routed.line + wiring.routed.address;
}

/// Writes the taxel positions as skinDynLib and skinManager of icub-main read them: one row per taxel with position (m)
/// and outward unit normal in the mesh frame. The two temperature pads and missing triangles have zeros and
/// representative −1; every other taxel is represented by taxel 3 of its triangle, the middle one. Errors: InputError
/// for a module in no patch, and for more than kIcubBoards patches. Cost: O(modules).
[[nodiscard]] std::string icub_positions(const design::Design& design);

/// Writes the drawing of the part for skinGui: the lattice of each island in mm, side by side, seen from outside (no
/// mirror), with orientations that draw each pad at its place. Errors: as icub_positions(), and for patches whose
/// triangles exceed kSkinGuiTriangles. Cost: O(modules).
[[nodiscard]] std::string icub_skingui(const design::Design& design);

}  // namespace triskin::exports
