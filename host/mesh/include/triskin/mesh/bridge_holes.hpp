// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

struct BridgeReport {
  int bridged = 0;
  /// These holes stay open because the part stands out of them, as the head of a screw does.
  int kept_out = 0;
  int left_open = 0;      ///< These stay open because their lid would cross the surface.
  double area_mm2 = 0.0;  ///< All lids together have this area.
};

/// Closes the holes of a surface whose border is nowhere wider than `diameter_mm` > 0 by flat lids, so that modules may
/// span them (docs/side.md). `part` is what the surface was taken from: what stands more than 0.5 mm out of a hole
/// keeps it open. The surface stays one that usable() accepts. Cost: O(n log n), and O(b³) of b border edges a hole.
BridgeReport bridge_holes(Mesh& surface, const Mesh& part, double diameter_mm);

}  // namespace triskin::geometry
