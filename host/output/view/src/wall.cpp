// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>

#include "triskin/view/notes.hpp"

namespace triskin::view {
namespace {

using design::Vec3;

constexpr double kCell_mm = 20.0;
constexpr double kAbove_mm = 6.0;  // A module lies at most a few mm above or below its surface.
constexpr double kMaxWall_mm = 8.0;
constexpr double kMinFacing = 0.3;  // The limit is the cosine to the ray: a steeper face belongs to a rim.

using Cell = std::array<int, 3>;

std::uint64_t key_of(const Cell& c) {
  std::uint64_t key = 0;
  for (const int v : c) key = key << 21U | (static_cast<std::uint64_t>(v) & 0x1FFFFFU);
  return key;
}

template <class Visit>
void each_cell(const Vec3& a, const Vec3& b, Visit visit) {
  Cell low{}, high{};
  for (int x = 0; x < 3; ++x) {
    low[static_cast<std::size_t>(x)] = static_cast<int>(std::floor(std::min(a[x], b[x]) / kCell_mm));
    high[static_cast<std::size_t>(x)] = static_cast<int>(std::floor(std::max(a[x], b[x]) / kCell_mm));
  }
  for (int i = low[0]; i <= high[0]; ++i) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int k = low[2]; k <= high[2]; ++k) visit(key_of({i, j, k}));
    }
  }
}

// Sorts faces into the cells that their boxes touch.
class FaceGrid {
 public:
  explicit FaceGrid(const design::Mesh& mesh) : mesh_(mesh) {
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
      const auto [a, b, c] = corners(f);
      each_cell(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), [&](std::uint64_t k) { cells_[k].push_back(f); });
    }
  }

  struct Crossing {
    double at_mm = 0.0;
    double facing = 0.0;  // A value above 0 means that the face looks towards the ray's origin.
  };
  // Returns the crossings of a short ray with faces, nearest first; a face is listed once for each cell that it shares
  // with the ray.
  [[nodiscard]] std::vector<Crossing> crossings(const Vec3& from, const Vec3& along, double length_mm) const {
    std::vector<Crossing> found;
    each_cell(from, from + length_mm * along, [&](std::uint64_t key) {
      const auto cell = cells_.find(key);
      if (cell == cells_.end()) return;
      for (const int f : cell->second) {
        const auto hit = crossing(f, from, along);
        if (hit && hit->at_mm >= 0.0 && hit->at_mm <= length_mm) found.push_back(*hit);
      }
    });
    std::ranges::sort(found, {}, &Crossing::at_mm);
    return found;
  }

 private:
  [[nodiscard]] std::array<Vec3, 3> corners(int face) const {
    const auto& f = mesh_.faces[static_cast<std::size_t>(face)];
    const auto at = [&](int v) { return mesh_.vertices[static_cast<std::size_t>(v)]; };
    return {at(f[0]), at(f[1]), at(f[2])};
  }
  [[nodiscard]] std::optional<Crossing> crossing(int face, const Vec3& from, const Vec3& along) const {
    const auto [a, b, c] = corners(face);
    const Vec3 n = (b - a).cross(c - a);
    const double slope = n.dot(along), size = n.norm();
    if (std::abs(slope) < 1e-9 * size || size == 0.0) return std::nullopt;
    const double t = n.dot(a - from) / slope;
    const Vec3 p = from + t * along;
    const std::array<Vec3, 3> corner{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& q = corner[k];
      if (n.dot((corner[(k + 1) % 3] - q).cross(p - q)) < 0.0) return std::nullopt;
    }
    return Crossing{t, -slope / size};
  }

  const design::Mesh& mesh_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

double wall_under(const design::PlacedModule& m, const FaceGrid& part) {
  const Vec3 center = (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
  const Vec3 normal = (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
  const auto hits = part.crossings(center + kAbove_mm * normal, -normal, 2.0 * kAbove_mm + kMaxWall_mm);
  double outer = std::numeric_limits<double>::infinity();
  for (const auto& hit : hits) {
    if (hit.facing > kMinFacing && std::abs(hit.at_mm - kAbove_mm) < std::abs(outer - kAbove_mm)) outer = hit.at_mm;
  }
  for (const auto& hit : hits) {
    if (hit.facing < -kMinFacing && hit.at_mm > outer)
      return hit.at_mm - outer <= kMaxWall_mm ? hit.at_mm - outer : 0.0;
  }
  return 0.0;
}

// A face of the part belongs to the covered surface if a face of that lies on it. Repairs and bridges move a surface by
// less than this.
constexpr double kOnSurface_mm = 0.1;

bool is_covered(const design::Mesh& part, const std::array<int, 3>& face, const FaceGrid& surface) {
  const auto at = [&](std::size_t k) { return part.vertices[static_cast<std::size_t>(face[k])]; };
  const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
  const Vec3 from = (at(0) + at(1) + at(2)) / 3.0 + kOnSurface_mm * normal;
  const auto hits = surface.crossings(from, -normal, 2.0 * kOnSurface_mm);
  return std::ranges::any_of(hits, [](const auto& hit) { return hit.facing > 0.0; });
}

}  // namespace

design::Mesh left_out_of_part(const design::Design& design) {
  design::Mesh rest;
  if (!design.side) return rest;
  const design::Mesh& part = design.side->part;
  const FaceGrid surface(design.surface);
  std::vector<int> number(part.vertices.size(), -1);
  for (const auto& face : part.faces) {
    if (is_covered(part, face, surface)) continue;
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      int& n = number[static_cast<std::size_t>(face[k])];
      if (n < 0) {
        n = static_cast<int>(rest.vertices.size());
        rest.vertices.push_back(part.vertices[static_cast<std::size_t>(face[k])]);
      }
      corners[k] = n;
    }
    rest.faces.push_back(corners);
  }
  return rest;
}

std::vector<double> wall_under_modules(const design::Design& design) {
  if (!design.side || design.side->part.faces.empty()) return {};
  const FaceGrid part(design.side->part);
  std::vector<double> wall_mm;
  for (const auto& m : design.layout.modules) wall_mm.push_back(wall_under(m, part));
  return wall_mm;
}

}  // namespace triskin::view
