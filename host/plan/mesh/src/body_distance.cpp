// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/body_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "triskin/base/index.hpp"
#include "triskin/geometry/triangle.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

constexpr double kBeyond_mm = 1e7;  // Every part is smaller than this, since no part exceeds 5 m.
constexpr double kAlong_mm = 0.1;   // Modules may overrun a keep-out by five times this.

// These directions match no symmetry of common parts, so rays rarely hit an edge; two of three rays decide.
const std::array<Vec3, 3> kInsideRays{Vec3(0.5773, 0.2113, 0.7887).normalized(),
                                      Vec3(-0.3127, 0.8231, 0.4741).normalized(),
                                      Vec3(0.1931, -0.5519, -0.8113).normalized()};

std::vector<Bvh::Extent> extents_of(const Mesh& mesh) {
  std::vector<Bvh::Extent> extents;
  for (const auto& f : mesh.faces) {
    Bvh::Extent e{mesh.vertices[at(f[0])].array(), mesh.vertices[at(f[0])].array()};
    for (const int v : f) {
      e[0] = e[0].min(mesh.vertices[at(v)].array());
      e[1] = e[1].max(mesh.vertices[at(v)].array());
    }
    extents.push_back(e);
  }
  return extents;
}

bool has_even_edges(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> faces_at;
  for (const auto& f : mesh.faces) {
    for (std::size_t s = 0; s < 3; ++s) ++faces_at[std::minmax(f[s], f[(s + 1) % 3])];
  }
  return std::ranges::all_of(faces_at, [](const auto& edge) { return edge.second % 2 == 0; });
}

// Returns 1 if the ray leaves through the triangle, −1 if it enters, and 0 if it misses.
int passage(const Vec3& from, const Vec3& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, p = ray.cross(v), s = from - a, q = s.cross(u);
  const double det = u.dot(p);
  if (det == 0.0) return 0;
  const double x = s.dot(p) / det, y = q.dot(ray) / det, t = q.dot(v) / det;
  if (x < 0.0 || y < 0.0 || x + y > 1.0 || t <= 0.0) return 0;
  return det < 0.0 ? 1 : -1;
}

}  // namespace

BodyDistance::BodyDistance(Mesh mesh)
    : mesh_(std::move(mesh)), is_closed_(has_even_edges(mesh_)), tree_(extents_of(mesh_)) {}

double BodyDistance::distance_mm(const Vec3& p, double at_most_mm) const {
  double best = at_most_mm * at_most_mm;
  tree_.nearest(p, best, [&](int face) {
    const auto& f = mesh_.faces[at(face)];
    const Vec3 &a = mesh_.vertices[at(f[0])], &b = mesh_.vertices[at(f[1])], &c = mesh_.vertices[at(f[2])];
    const Vec3 w = geometry::closest_on_triangle(p, a, b, c);
    best = std::min(best, (p - w[0] * a - w[1] * b - w[2] * c).squaredNorm());
  });
  return std::sqrt(best);
}

int BodyDistance::windings(const Vec3& p, const Vec3& direction) const {
  double end = kBeyond_mm;
  int sum = 0;
  tree_.along(p, direction, end, [&](int face) {
    const auto& f = mesh_.faces[at(face)];
    sum += passage(p, direction, mesh_.vertices[at(f[0])], mesh_.vertices[at(f[1])], mesh_.vertices[at(f[2])]);
  });
  return sum;
}

bool BodyDistance::contains(const Vec3& p) const {
  return is_closed_ && std::ranges::count_if(kInsideRays, [&](const Vec3& ray) { return windings(p, ray) != 0; }) >= 2;
}

double BodyDistance::signed_mm(const Vec3& p) const {
  const double distance = distance_mm(p, std::numeric_limits<double>::infinity());
  return contains(p) ? -distance : distance;
}

// A neighbour on the line bounds the distance here, and tells the side unless the surface may lie between the two.
BodyDistance::Probe BodyDistance::probe_beside(const Line& line, double t, const Probe& known) const {
  const double apart_mm = std::abs(t - known.t), known_mm = std::abs(known.signed_mm);
  const Vec3 p = line.from + t * line.direction;
  const double distance = distance_mm(p, known_mm + apart_mm);
  const bool is_inside = known_mm > apart_mm ? known.signed_mm < 0.0 : contains(p);
  return {t, is_inside ? -distance : distance};
}

// The signed distance changes no faster than the position, so between two probes it stays above the place where the
// steepest slopes from both meet; the next probe goes there (Piyavskii 1972, Shubert 1972).
void BodyDistance::search_between(const Line& line, const Probe& a, const Probe& b, double& least_mm) const {
  const double bound_mm = 0.5 * (a.signed_mm + b.signed_mm - (b.t - a.t));
  if (bound_mm >= least_mm - kAlong_mm) return;
  if (bound_mm > line.enough_mm) {
    least_mm = bound_mm;
    return;
  }
  const double t = std::clamp(0.5 * (a.t + b.t + a.signed_mm - b.signed_mm), a.t, b.t);
  const Probe middle = probe_beside(line, t, t - a.t < b.t - t ? a : b);
  least_mm = std::min(least_mm, middle.signed_mm);
  search_between(line, a, middle, least_mm);
  search_between(line, middle, b, least_mm);
}

double BodyDistance::least_along_mm(const Vec3& from, const Vec3& direction, double length_mm, double enough_mm) const {
  const Line line{from, direction, enough_mm};
  const Probe middle{0.5 * length_mm, signed_mm(from + 0.5 * length_mm * direction)};
  if (middle.signed_mm - 0.5 * length_mm > enough_mm) return middle.signed_mm - 0.5 * length_mm;
  const Probe first = probe_beside(line, 0.0, middle), last = probe_beside(line, length_mm, middle);
  double least_mm = std::min({first.signed_mm, middle.signed_mm, last.signed_mm});
  search_between(line, first, middle, least_mm);
  search_between(line, middle, last, least_mm);
  return least_mm;
}

}  // namespace triskin::mesh
