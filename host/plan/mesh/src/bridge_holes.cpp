// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/bridge_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "edge_sides.hpp"
#include "polygon_faces.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract.hpp"

namespace triskin::mesh {
namespace {

// A module lies up to a millimetre above a rough surface; a countersunk head that ends flush is under this.
constexpr double kMaxBump_mm = 0.5;
constexpr std::size_t kMaxSingleTries = 64;  // Each one costs a search for crossing faces.

constexpr std::size_t kMaxBorder = 2000;  // Ears are searched in cubic time.

struct Hole {
  std::vector<VertexIndex> border;  // The surface lies on the left of the border.
  Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
  double radius_mm = 0.0;
};

Hole hole_of(const Mesh& mesh, const std::vector<VertexIndex>& loop) {
  Hole hole{loop};
  for (const VertexIndex v : loop) hole.middle += mesh.vertices[at(v)] / static_cast<double>(loop.size());
  // Newell's normal is used, and the border of a hole runs clockwise round it.
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 a = mesh.vertices[at(loop[k])] - hole.middle,
               b = mesh.vertices[at(loop[(k + 1) % loop.size()])] - hole.middle;
    hole.normal -= a.cross(b);
    hole.radius_mm = std::max(hole.radius_mm, a.norm());
  }
  hole.normal.normalize();
  return hole;
}

bool sticks_out(const Mesh& part, const Hole& hole) {
  return std::ranges::any_of(part.vertices, [&](const Vec3& v) {
    const Vec3 d = v - hole.middle;
    if (d.squaredNorm() > 4.0 * hole.radius_mm * hole.radius_mm) return false;
    const double height = d.dot(hole.normal);
    return height > kMaxBump_mm && (d - height * hole.normal).norm() < 0.9 * hole.radius_mm;
  });
}

Mesh with_lids(const Mesh& surface, const std::vector<Hole>& holes) {
  Mesh mesh = surface;
  for (const Hole& hole : holes) add_polygon(mesh, {hole.border.rbegin(), hole.border.rend()});
  return mesh;
}

double area_from(const Mesh& mesh, std::size_t first) {
  double area = 0.0;
  for (std::size_t f = first; f < mesh.faces.size(); ++f) {
    const auto& c = mesh.faces[f];
    const Vec3& a = mesh.vertices[at(c[0])];
    area += 0.5 * (mesh.vertices[at(c[1])] - a).cross(mesh.vertices[at(c[2])] - a).norm();
  }
  return area;
}

}  // namespace

BridgeReport bridge_holes(Mesh& surface, const Mesh& part, double diameter_mm) {
  BridgeReport report;
  std::vector<Hole> holes;
  for (const std::vector<VertexIndex>& loop : border_loops_of(surface, neighbours_of(surface))) {
    if (loop.size() < 3 || loop.size() > kMaxBorder || width_of_loop(surface, loop) > diameter_mm) continue;
    holes.push_back(hole_of(surface, loop));
    if (!sticks_out(part, holes.back())) continue;
    holes.pop_back();
    ++report.kept_out;
  }
  if (holes.empty()) return report;
  Mesh bridged = with_lids(surface, holes);
  if (!usable(bridged)) {
    std::vector<Hole> fitting;
    for (std::size_t k = 0; k < holes.size() && k < kMaxSingleTries; ++k) {
      fitting.push_back(holes[k]);
      if (!usable(with_lids(surface, fitting))) fitting.pop_back();
    }
    report.left_open = static_cast<int>(holes.size() - fitting.size());
    holes = std::move(fitting);
    bridged = with_lids(surface, holes);
  }
  report.bridged = static_cast<int>(holes.size());
  report.area_mm2 = area_from(bridged, surface.faces.size());
  surface = std::move(bridged);
  return report;
}

}  // namespace triskin::mesh
