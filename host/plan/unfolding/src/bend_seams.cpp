// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/unfolding/bend_seams.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::unfolding {
namespace {

constexpr int kDirections = 12;
constexpr double kCircumradius_mm = 2.0 * kHeight_mm / 3.0;
constexpr double kOnBorder_mm = 1e-6;

Vec3 middle_of(const Mesh& mesh, FaceIndex face) {
  const auto& f = mesh.faces[at(face)];
  return (mesh.vertices[at(f[0])] + mesh.vertices[at(f[1])] + mesh.vertices[at(f[2])]) / 3.0;
}

double area_of(const Mesh& mesh, FaceIndex face) {
  const auto& f = mesh.faces[at(face)];
  const Vec3& a = mesh.vertices[at(f[0])];
  return 0.5 * (mesh.vertices[at(f[1])] - a).cross(mesh.vertices[at(f[2])] - a).norm();
}

double bending_radius(const mesh::Surface& surface, FaceIndex face) {
  const mesh::SurfacePoint here = surface.closest(middle_of(surface.mesh(), face));
  const Vec3 n = surface.normal_at(here), x = n.unitOrthogonal(), y = n.cross(x);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * M_PI * k / kDirections;
    const mesh::SurfacePoint there =
        surface.closest(here.position_mm + kCircumradius_mm * (std::cos(angle) * x + std::sin(angle) * y));
    if (surface.border_distance(there.position_mm) <= kOnBorder_mm) continue;
    const Vec3 m = surface.normal_at(there);
    const double turn = std::atan2(n.cross(m).norm(), n.dot(m));
    if (turn > 1e-6) least = std::min(least, (there.position_mm - here.position_mm).norm() / turn);
  }
  return least;
}

// Finds connected faces of one kind and changes the kind of those that are smaller than a module.
void give_up_small_parts(const mesh::Surface& surface, std::vector<char>& is_tight) {
  const int count = static_cast<int>(is_tight.size());
  std::vector<char> seen(is_tight.size(), 0);
  const std::vector<char> before = is_tight;
  for (FaceIndex first{0}; first < count; ++first) {
    if (seen[at(first)] != 0) continue;
    std::vector<FaceIndex> part{first};
    seen[at(first)] = 1;
    double area_mm2 = 0.0;
    for (std::size_t k = 0; k < part.size(); ++k) {
      area_mm2 += area_of(surface.mesh(), part[k]);
      for (const FaceIndex n : surface.neighbours(part[k])) {
        if (n < 0 || seen[at(n)] != 0 || before[at(n)] != before[at(first)]) continue;
        seen[at(n)] = 1;
        part.push_back(n);
      }
    }
    if (area_mm2 >= kModuleArea_mm2) continue;
    for (const FaceIndex f : part) is_tight[at(f)] = before[at(first)] != 0 ? 0 : 1;
  }
}

}  // namespace

std::vector<double> bending_radii(const mesh::Surface& surface) {
  std::vector<double> radii;
  for (FaceIndex f{0}; f < static_cast<int>(surface.mesh().faces.size()); ++f)
    radii.push_back(bending_radius(surface, f));
  return radii;
}

std::vector<SurfaceEdge> seams_along_bends(const mesh::Surface& surface, double radius_mm) {
  if (!(radius_mm > 0.0)) throw InputError(fmt::format("bending radius {} mm: must be positive", radius_mm));
  std::vector<char> is_tight;
  for (const double r : bending_radii(surface)) is_tight.push_back(r < radius_mm ? 1 : 0);
  give_up_small_parts(surface, is_tight);
  std::vector<SurfaceEdge> edges;
  for (FaceIndex f{0}; f < static_cast<int>(is_tight.size()); ++f) {
    for (int s = 0; s < 3; ++s) {
      const FaceIndex n = surface.neighbours(f)[at(s)];
      if (n > f && is_tight[at(n)] != is_tight[at(f)]) edges.push_back({f, s});
    }
  }
  return edges;
}

}  // namespace triskin::unfolding
