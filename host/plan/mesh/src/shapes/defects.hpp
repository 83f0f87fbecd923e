// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Adds the faults of CAD exports to a clean cover: a second wall 3 mm inside, ribs on its outer wall (three faces at
/// an edge), bosses inside, T-junctions, duplicate, flipped and degenerate faces, vertices that faces do not share.
[[nodiscard]] Mesh as_dirty_shell(const Mesh& cover);

/// Cuts faces of the same surface into needles and slivers (2e-4 … 1e-2 mm), with edges of 2e-6 mm.
[[nodiscard]] Mesh with_near_degenerate_faces(const Mesh& cover);

}  // namespace triskin::mesh
