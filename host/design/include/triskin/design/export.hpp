// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Picture of a design (SVG): the surface from the side that shows most modules, modules coloured by patch, the tree of
/// each patch as lines from the entry (dot).
[[nodiscard]] std::string picture_svg(const Design& design);

/// Taxels, one row each: module, taxel, patch, line, address, position and normal in the mesh frame, mm.
[[nodiscard]] std::string taxels_csv(const Design& design);

/// Assembly sheet (HTML, prints on A4): per patch the module's straps, rotation, input side, parent and cut joints.
[[nodiscard]] std::string assembly_html(const Design& design);

/// Modules as a mesh (OBJ), one group a patch.
[[nodiscard]] std::string modules_obj(const Design& design);

}  // namespace triskin::design
