// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Triangles of one board on the bus of an iCub, whether the board has them or not, and boards with an iCub stream.
inline constexpr int kIcubTriangles = 16, kIcubBoards = 14;
/// Triangles that skinGui draws.
inline constexpr int kSkinGuiTriangles = 128;

/// Number of a module among the triangles of a part, as the host orders them: 16 * patch + 4 · line + address. Taxel t
/// of it is value 12 · number + t of the part's port.
[[nodiscard]] constexpr int icub_triangle(const ModuleWiring& wiring) {
  return kIcubTriangles * wiring.patch + 4 * wiring.routed.line + wiring.routed.address;
}

/// File of taxel positions as skinDynLib and skinManager of icub-main read it: one row a taxel, place (m) and outward
/// unit normal in the mesh frame; zeros and representative −1 for the two pads of temperature and for triangles that
/// are not there; every other taxel is represented by taxel 3 of its triangle, the middle one. Errors: InputError for
/// a module in no patch, and for more than kIcubBoards patches. Cost: O(modules).
[[nodiscard]] std::string icub_positions(const Design& design);

/// Drawing of the part for skinGui: each island as its lattice is, mm, side by side, seen from outside (no mirror),
/// with orientations so that each pad is drawn where it lies. Errors: as icub_positions(), and for patches whose
/// triangles reach beyond kSkinGuiTriangles. Cost: O(modules).
[[nodiscard]] std::string icub_skingui(const Design& design);

}  // namespace triskin::design
