// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Covers of our own, as hard as those of a robot (docs/generate.md).
enum class Shape : std::uint8_t { kForearm, kTorso, kHip, kThigh, kDirtyShell, kNearDegenerate };

/// Row of the table of shapes: the one place where their names stand.
struct ShapeInfo {
  Shape shape;
  std::string_view name;     ///< The name is that of the command line and of the tests.
  std::string_view summary;  ///< The summary tells what makes the shape hard.
  double size_mm;            ///< generate() gives this largest side of the bounding box when no size is asked for.
  int faces;                 ///< It asks for this number of faces when none is given.
};

/// Every shape, in the order of the enumeration.
[[nodiscard]] std::span<const ShapeInfo> generated_shapes();
/// Shape of this name; nothing when there is none.
[[nodiscard]] std::optional<Shape> shape_named(std::string_view name);

struct GenerateOptions {
  double size_mm = 0.0;  ///< The largest side of the bounding box is 20 … 5000 mm; 0 takes that of the table.
  int faces = 0;         ///< The number of faces, 50 … 2,000,000, is met within a fifth; 0 takes the table's.
};

/// Triangle mesh of a cover, mm. kForearm … kThigh are oriented manifolds without self-intersection, normals outwards
/// (those of kForearm inwards, as in release 0.1); kDirtyShell has what CAD exports have (two walls, ribs, loose parts,
/// duplicate, flipped and degenerate faces, T-junctions, unshared vertices) and needs extract(); kNearDegenerate is the
/// surface of kHip cut into needles, slivers and edges from 2e-6 mm on, and a manifold once read_mesh() has welded it.
/// Equal for equal options. Throws InputError naming an option out of its range. Cost: linear in the faces.
[[nodiscard]] Mesh generate(Shape shape, const GenerateOptions& options = {});

}  // namespace triskin::geometry
