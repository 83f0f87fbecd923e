// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "canonical.hpp"
#include "net.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::lattice {

/// Makes a net of fixed modules alone: kept[k] (of the original, neighbours among `kept`) becomes triangle k. `surface`
/// is that of the copy.
[[nodiscard]] LatticeMesh net_of_kept(const mesh::Surface& surface, const CanonicalCopy& copy,
                                      const std::vector<PlacedModule>& kept, double corner_cut_mm);

/// Restores the kept modules, which come first in a layout that was carried back: exact positions, kinds, and the
/// joints among them.
void restore_kept(const std::vector<PlacedModule>& kept, ModuleLayout& layout);

}  // namespace triskin::lattice
