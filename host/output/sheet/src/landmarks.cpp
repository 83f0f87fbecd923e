// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/landmarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "triskin/geometry/segment.hpp"

namespace triskin::sheet {
namespace {

using design::Mesh;
using design::Vec3;

constexpr double kShortestRim_mm = 30.0, kSameHeight_mm = 0.5, kApart_mm = 5.0;
constexpr std::array<const char*, 6> kDirections{"+x", "−x", "+y", "−y", "+z", "−z"};

// Gives for each vertex the next one along the rim: an edge that one face uses, against the direction of that face.
std::map<int, int> rim_edges(const Mesh& surface) {
  std::map<std::array<int, 2>, int> uses;
  for (const auto& f : surface.faces) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[{f[k], f[(k + 1) % 3]}];
  }
  std::map<int, int> next;
  for (const auto& [edge, count] : uses) {
    if (!uses.contains({edge[1], edge[0]})) next[edge[1]] = edge[0];
  }
  return next;
}

// Returns closed chains of rim edges. A vertex where two rims touch has one successor here, so that each edge is walked
// once.
std::vector<std::vector<Vec3>> rims_of(const Mesh& surface) {
  std::map<int, int> next = rim_edges(surface);
  std::vector<std::vector<Vec3>> rims;
  while (!next.empty()) {
    std::vector<Vec3> rim;
    auto at = next.begin();
    while (at != next.end()) {
      rim.push_back(surface.vertices.at(static_cast<std::size_t>(at->first)));
      const int to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    rims.push_back(std::move(rim));
  }
  return rims;
}

double length_mm(const std::vector<Vec3>& rim) {
  double length = 0.0;
  for (std::size_t k = 0; k < rim.size(); ++k) length += (rim[(k + 1) % rim.size()] - rim[k]).norm();
  return length;
}

// Returns how sharply a closed chain turns at a point: −1 straight on, 1 back.
double turn_at(const std::vector<Vec3>& chain, std::size_t k) {
  const Vec3 in = chain[k] - chain[(k + chain.size() - 1) % chain.size()],
             out = chain[(k + 1) % chain.size()] - chain[k];
  return -in.dot(out) / std::max(1e-9, in.norm() * out.norm());
}

Vec3 farthest(const std::vector<Vec3>& points, const Vec3& direction, bool is_chain) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : points) most = std::max(most, direction.dot(p));
  std::size_t best = points.size();
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (direction.dot(points[k]) < most - kSameHeight_mm) continue;
    if (best == points.size() || (is_chain && turn_at(points, k) > turn_at(points, best) + 1e-9)) best = k;
  }
  return points[best];
}

void add_landmarks(const std::vector<Vec3>& points, bool is_rim, const std::string& of, std::vector<Landmark>& found) {
  for (std::size_t d = 0; d < kDirections.size(); ++d) {
    const Vec3 direction = (d % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(static_cast<int>(d / 2));
    const Vec3 at = farthest(points, direction, is_rim);
    const auto near = [&](const Landmark& l) { return (l.at_mm - at).norm() < kApart_mm; };
    if (std::ranges::any_of(found, near)) continue;
    found.push_back({fmt::format("{}{}", is_rim ? 'R' : 'S', found.size() + 1), at,
                     fmt::format("point of {} farthest towards {}", of, kDirections[d])});
  }
}

}  // namespace

std::vector<Landmark> landmarks_of(const Mesh& surface) {
  std::vector<Landmark> found;
  if (surface.vertices.empty()) return found;
  auto rims = rims_of(surface);
  std::erase_if(rims, [](const auto& rim) { return length_mm(rim) < kShortestRim_mm; });
  std::ranges::stable_sort(rims, std::greater{}, length_mm);
  for (std::size_t k = 0; k < rims.size(); ++k)
    add_landmarks(rims[k], true,
                  rims.size() == 1 ? "the rim" : fmt::format("rim {} ({:.0f} mm long)", k + 1, length_mm(rims[k])),
                  found);
  if (rims.empty()) add_landmarks(surface.vertices, false, "the part", found);
  return found;
}

Fix fix_of(const std::vector<Landmark>& landmarks, const Vec3& at_mm) {
  Fix best;
  double best_mm = std::numeric_limits<double>::infinity();
  bool best_meets = false;
  for (std::size_t a = 0; a < landmarks.size(); ++a) {
    for (std::size_t b = a + 1; b < landmarks.size(); ++b) {
      const Vec3 u = landmarks[a].at_mm - at_mm, v = landmarks[b].at_mm - at_mm;
      const double sum_mm = u.norm() + v.norm();
      const bool meets = u.cross(v).norm() >= 0.5 * u.norm() * v.norm() && u.norm() > 1.0 && v.norm() > 1.0;
      if (meets < best_meets || (meets == best_meets && sum_mm >= best_mm)) continue;
      best = {{static_cast<int>(a), static_cast<int>(b)}, {u.norm(), v.norm()}};
      best_mm = sum_mm;
      best_meets = meets;
    }
  }
  if (landmarks.size() == 1) best = {{0, -1}, {(landmarks[0].at_mm - at_mm).norm(), 0.0}};
  return best;
}

std::vector<std::array<Vec3, 2>> rim_edges_of(const Mesh& surface) {
  std::vector<std::array<Vec3, 2>> edges;
  for (const auto& [from, to] : rim_edges(surface))
    edges.push_back(
        {surface.vertices.at(static_cast<std::size_t>(from)), surface.vertices.at(static_cast<std::size_t>(to))});
  return edges;
}

double distance_to_mm(const std::vector<std::array<Vec3, 2>>& edges, const Vec3& at_mm) {
  double nearest_mm = -1.0;
  for (const auto& [from, to] : edges) {
    const double distance_mm = geometry::distance_to_segment(at_mm, from, to);
    if (nearest_mm < 0.0 || distance_mm < nearest_mm) nearest_mm = distance_mm;
  }
  return nearest_mm;
}

}  // namespace triskin::sheet
