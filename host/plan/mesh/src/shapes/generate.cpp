// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/generate.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "covers.hpp"
#include "defects.hpp"
#include "triskin/base/error.hpp"

namespace triskin::mesh {
namespace {

constexpr double kSmallest_mm = 20.0, kLargest_mm = 5000.0;
constexpr int kMinFaces = 50, kMaxFaces = 2'000'000;
// The defects turn each face of the clean cover into this many, on average.
constexpr double kDirtyFaces = 2.25, kNearDegenerateFaces = 1.52;

constexpr std::array kShapes{
    ShapeInfo{Shape::kForearm, "forearm", "tapered and bent half shell", 294.0, 3840},
    ShapeInfo{Shape::kTorso, "torso", "dome with two swellings, holes for neck, arms and a connector", 195.0, 1800},
    ShapeInfo{Shape::kHip, "hip", "saddle between two wings, cut out for both legs", 220.0, 1000},
    ShapeInfo{Shape::kThigh, "thigh", "double-curved tube with a crest, a hole and a folded lip", 180.0, 1200},
    ShapeInfo{
        Shape::kDirtyShell, "dirty-shell",
        "CAD export of the hip: two walls, ribs, loose parts, T-junctions, flipped, duplicate and degenerate faces",
        220.0, 6000},
    ShapeInfo{Shape::kNearDegenerate, "near-degenerate", "small hip cut into needles, slivers and tiny edges", 130.0,
              1000},
};

// Scales the mesh so that the largest side of its bounding box is `size_mm`.
Mesh scaled(Mesh mesh, double size_mm) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  const double scale = size_mm / box.sizes().maxCoeff();
  for (Vec3& v : mesh.vertices) v *= scale;
  return mesh;
}

void require_range(const GenerateOptions& options) {
  if (options.size_mm != 0.0 && !(options.size_mm >= kSmallest_mm && options.size_mm <= kLargest_mm))
    throw InputError(
        fmt::format("generate: size {} mm is not in {} … {} mm", options.size_mm, kSmallest_mm, kLargest_mm));
  if (options.faces != 0 && !(options.faces >= kMinFaces && options.faces <= kMaxFaces))
    throw InputError(fmt::format("generate: {} faces are not in {} … {}", options.faces, kMinFaces, kMaxFaces));
}

int share(int faces, double of_one) {
  return static_cast<int>(faces / of_one);
}

}  // namespace

std::span<const ShapeInfo> generated_shapes() {
  return kShapes;
}

std::optional<Shape> shape_named(std::string_view name) {
  const auto* const row = std::ranges::find(kShapes, name, &ShapeInfo::name);
  if (row == kShapes.end()) return std::nullopt;
  return row->shape;
}

Mesh generate(Shape shape, const GenerateOptions& options) {
  require_range(options);
  const ShapeInfo& row = kShapes[static_cast<std::size_t>(shape)];
  const double size_mm = options.size_mm != 0.0 ? options.size_mm : row.size_mm;
  const int faces = options.faces != 0 ? options.faces : row.faces;
  switch (shape) {
    case Shape::kForearm:
      return options.size_mm == 0.0 ? forearm(faces) : scaled(forearm(faces), size_mm);
    case Shape::kTorso:
      return scaled(mesh_of(torso(), faces), size_mm);
    case Shape::kHip:
      return scaled(mesh_of(hip(), faces), size_mm);
    case Shape::kThigh:
      return scaled(mesh_of(thigh(), faces), size_mm);
    case Shape::kDirtyShell:
      return as_dirty_shell(scaled(mesh_of(hip(), share(faces, kDirtyFaces)), size_mm));
    case Shape::kNearDegenerate:
      return with_near_degenerate_faces(scaled(mesh_of(hip(), share(faces, kNearDegenerateFaces)), size_mm));
  }
  throw InputError("generate: no such shape");
}

}  // namespace triskin::mesh
