// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray_caster.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "triangle_tree.hpp"
#include "triskin/base/index.hpp"

namespace triskin::mesh {
namespace {

constexpr double kMiss = -1.0;

// Follows Möller, Trumbore, Fast, minimum storage ray/triangle intersection, 1997. Returns a negative value for a ray
// that misses.
double distance_along(const Mesh& mesh, FaceIndex face, const Vec3& from, const Vec3& direction) {
  const auto& f = mesh.faces[at(face)];
  const Vec3& a = mesh.vertices[at(f[0])];
  const Vec3 ab = mesh.vertices[at(f[1])] - a, ac = mesh.vertices[at(f[2])] - a;
  const Vec3 p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return kMiss;
  const Vec3 s = from - a;
  const double u = s.dot(p) / determinant;
  if (u < 0.0 || u > 1.0) return kMiss;
  const Vec3 q = s.cross(ab);
  const double v = direction.dot(q) / determinant;
  if (v < 0.0 || u + v > 1.0) return kMiss;
  return ac.dot(q) / determinant;
}

}  // namespace

RayCaster::RayCaster(const Mesh& mesh, int threads) : mesh_(mesh), tree_(tree_of_faces(mesh, threads)) {
  normals_.reserve(mesh.faces.size());
  areas_mm2_.reserve(mesh.faces.size());
  for (const auto& f : mesh.faces) {
    const Vec3& a = mesh.vertices[at(f[0])];
    const Vec3 cross = (mesh.vertices[at(f[1])] - a).cross(mesh.vertices[at(f[2])] - a);
    const double length = cross.norm();
    normals_.push_back(length > 0.0 ? Vec3(cross / length) : Vec3::Zero());
    areas_mm2_.push_back(0.5 * length);
  }
}

RayHit RayCaster::first_hit(const Vec3& from_mm, const Vec3& direction, double nearest_mm, double farthest_mm,
                            FaceIndex but_face) const {
  RayHit hit;
  double end = farthest_mm;
  tree_.along(from_mm, direction, end, [&](int item) {
    const FaceIndex face(item);
    if (face == but_face) return;
    const double t = distance_along(mesh_, face, from_mm, direction);
    if (t < nearest_mm || t >= end) return;
    end = t;
    hit = {face, t};
  });
  return hit;
}

bool RayCaster::is_free(const Vec3& from_mm, const Vec3& direction, double farthest_mm) const {
  double end = farthest_mm;
  tree_.along(from_mm, direction, end, [&](int item) {
    if (distance_along(mesh_, FaceIndex(item), from_mm, direction) > 0.0) end = -1.0;
  });
  return end >= 0.0;
}

}  // namespace triskin::mesh
