// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/patch.hpp"
#include "triskin/design/piece.hpp"
#include "triskin/design/polygon.hpp"
#include "triskin/design/price.hpp"
#include "triskin/design/tile.hpp"

/// Names of the design that the solvers use for their input and results.
namespace triskin::design_types {

using design::FaceIndex;
using design::FailureLoss;
using design::Jumper;
using design::JumperKind;
using design::LayoutLimits;
using design::LayoutMethod;
using design::LineElectrical;
using design::Mesh;
using design::ModuleGraph;
using design::ModuleLayout;
using design::Patch;
using design::Piece;
using design::PlacedModule;
using design::Placement;
using design::Polygon;
using design::Price;
using design::RoutedModule;
using design::Tile;
using design::TileSide;
using design::Vec2;
using design::Vec3;
using design::VertexIndex;

using design::across;
using design::grid_point;
using design::kHeight_mm;
using design::kModuleArea_mm2;
using design::kModulesAController;
using design::kSide_mm;
using design::tile_corner_index;

}  // namespace triskin::design_types

namespace triskin::mesh {
using namespace design_types;
}
namespace triskin::placement {
using namespace design_types;
}
namespace triskin::unfolding {
using namespace design_types;
}
namespace triskin::routing {
using namespace design_types;
}
namespace triskin::lattice {
using namespace design_types;
}
