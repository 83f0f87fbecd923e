// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "clean.hpp"
#include "edge_sides.hpp"
#include "triskin/base/index.hpp"
#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

constexpr std::size_t kAsked = 16;  // This many corners are sampled per part; one is enough if no two faces cross.

struct Part {
  std::vector<FaceIndex> faces;
  Eigen::AlignedBox3d box;
  double volume = 0.0;
  bool closed = true;
};

std::vector<Part> parts_of(const Mesh& mesh) {
  const std::vector<std::array<FaceIndex, 3>> neighbours = neighbours_of(mesh);
  std::vector<Part> parts;
  std::vector<bool> seen(mesh.faces.size(), false);
  for (std::size_t first = 0; first < seen.size(); ++first) {
    if (seen[first]) continue;
    Part part;
    part.faces.push_back(FaceIndex(first));
    seen[first] = true;
    for (std::size_t q = 0; q < part.faces.size(); ++q) {
      const auto& f = mesh.faces[at(part.faces[q])];
      const Vec3 &a = mesh.vertices[at(f[0])], &b = mesh.vertices[at(f[1])], &c = mesh.vertices[at(f[2])];
      part.volume += a.dot(b.cross(c)) / 6.0;
      part.box.extend(a).extend(b).extend(c);
      for (const FaceIndex n : neighbours[at(part.faces[q])]) {
        part.closed = part.closed && n >= 0;
        if (n < 0 || seen[at(n)]) continue;
        seen[at(n)] = true;
        part.faces.push_back(n);
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

// Returns how often a closed part winds around a point: the sum of the solid angles of its faces (van Oosterom,
// Strackee 1983).
double winding_number(const Mesh& mesh, const Part& part, const Vec3& p) {
  double angle = 0.0;
  for (const FaceIndex face : part.faces) {
    const auto& f = mesh.faces[at(face)];
    const Vec3 a = mesh.vertices[at(f[0])] - p, b = mesh.vertices[at(f[1])] - p, c = mesh.vertices[at(f[2])] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return angle / (2.0 * std::numbers::pi);
}

bool lies_in(const Mesh& mesh, const Part& inner, const Part& outer) {
  if (&inner == &outer || !outer.closed || !outer.box.contains(inner.box)) return false;
  const std::size_t step = 1 + inner.faces.size() / kAsked;
  for (std::size_t k = 0; k < inner.faces.size(); k += step) {
    const Vec3& corner = mesh.vertices[at(mesh.faces[at(inner.faces[k])][0])];
    if (std::abs(winding_number(mesh, outer, corner)) < 0.5) return false;
  }
  return true;
}

}  // namespace

int drop_enclosed(Mesh& mesh) {
  const std::vector<Part> parts = parts_of(mesh);
  std::vector<bool> is_enclosed(mesh.faces.size(), false);
  int dropped = 0;
  for (const Part& part : parts) {
    if (std::ranges::none_of(parts, [&](const Part& o) { return lies_in(mesh, part, o); })) continue;
    for (const FaceIndex f : part.faces) is_enclosed[at(f)] = true;
    ++dropped;
  }
  if (dropped == 0) return 0;
  std::vector<std::array<int, 3>> kept;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!is_enclosed[f]) kept.push_back(mesh.faces[f]);
  }
  mesh.faces = std::move(kept);
  drop_unused_vertices(mesh);
  return dropped;
}

int turn_outward(Mesh& mesh) {
  const std::vector<Part> parts = parts_of(mesh);
  int turned = 0;
  for (const Part& part : parts) {
    if (!part.closed || part.volume >= 0.0) continue;
    if (std::ranges::any_of(parts, [&](const Part& o) { return lies_in(mesh, part, o); })) continue;
    for (const FaceIndex f : part.faces) std::swap(mesh.faces[at(f)][1], mesh.faces[at(f)][2]);
    turned += static_cast<int>(part.faces.size());
  }
  return turned;
}

}  // namespace triskin::mesh
