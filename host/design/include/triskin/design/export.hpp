// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Picture of a design (SVG): the surface from the side that shows most modules, modules coloured by patch, the tree of
/// each patch as lines from the entry (dot). Errors: none for a design that was read or made. Cost: O(faces + modules).
[[nodiscard]] std::string picture_svg(const Design& design);

/// Taxels, one row each: module, taxel, patch, line, address, position (mm) and outward unit normal
/// in the mesh frame. Modules without a patch have −1 there. Cost: O(modules).
[[nodiscard]] std::string taxels_csv(const Design& design);

/// Assembly sheet (HTML, prints on A4): per patch the module's straps, rotation, input side, parent and cut joints.
/// Modules are named by id. Cost: O(modules).
[[nodiscard]] std::string assembly_html(const Design& design);

/// Modules as a mesh (OBJ, mm, mesh frame), one triangle a module and one group a patch. Cost: O(modules).
[[nodiscard]] std::string modules_obj(const Design& design);

}  // namespace triskin::design
