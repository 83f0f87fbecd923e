// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Names the generated covers, which are as hard as those of a robot (docs/mesh.md).
enum class Shape : std::uint8_t { kForearm, kTorso, kHip, kThigh, kDirtyShell, kNearDegenerate };

/// One row of the table of shapes, the only place that states their names.
struct ShapeInfo {
  Shape shape;
  std::string_view name;     ///< Command line and tests use this name.
  std::string_view summary;  ///< The summary tells what makes the shape hard.
  double size_mm;            ///< The bounding box gets this largest side unless the options give a size.
  int faces;                 ///< The mesh gets about this many faces unless the options give a number.
};

/// Lists every shape, in the order of the enumeration.
[[nodiscard]] std::span<const ShapeInfo> generated_shapes();
/// Returns nothing when no shape has this name.
[[nodiscard]] std::optional<Shape> shape_named(std::string_view name);

struct GenerateOptions {
  /// This is the largest side of the bounding box, 20 … 5000 mm; 0 selects the size in the table.
  double size_mm = 0.0;
  /// The result has this number of faces (50 … 2,000,000) within a fifth; 0 selects the number in the table.
  int faces = 0;
};

/// Makes the triangle mesh of a cover, in mm. kForearm … kThigh are oriented manifolds without self-intersection,
/// normals outwards (those of kForearm inwards); kDirtyShell has the faults of CAD exports (two
/// walls, ribs, loose parts, duplicate, flipped and degenerate faces, T-junctions, unshared vertices) and needs
/// extract(); kNearDegenerate is the surface of kHip cut into needles, slivers and edges from 2e-6 mm on, and a
/// manifold once read_mesh() has welded it. Equal options give equal meshes. Throws InputError naming an option out of
/// its range. Cost: linear in the faces.
[[nodiscard]] Mesh generate(Shape shape, const GenerateOptions& options = {});

}  // namespace triskin::mesh
