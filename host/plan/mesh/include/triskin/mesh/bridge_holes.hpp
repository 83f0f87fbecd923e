// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

struct BridgeReport {
  int bridged = 0;
  /// These holes stay open because the part stands out of them, as the head of a screw does.
  int kept_out = 0;
  int left_open = 0;      ///< These stay open because their lid would cross the surface.
  double area_mm2 = 0.0;  ///< All lids together have this area.
};

/// Closes holes by flat lids so that modules may span them (docs/mesh.md), if their border is nowhere wider than
/// `diameter_mm` > 0. The surface was taken from `part`; a hole stays open if the part extends more than 0.5 mm out of
/// it. The surface still passes usable() afterwards. Cost: O(n log n), and O(b³) for each hole of b border edges.
BridgeReport bridge_holes(Mesh& surface, const Mesh& part, double diameter_mm);

}  // namespace triskin::mesh
