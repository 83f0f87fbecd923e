// SPDX-License-Identifier: GPL-3.0-or-later
// Distance between two sets of triangles with a proved upper bound: the distance to one triangle is convex, so over a
// triangle it is largest at a corner.
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <queue>
#include <set>
#include <utility>
#include <vector>

#include "extract_steps.hpp"
#include "index.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {
namespace {

constexpr double kTolerance_mm = 0.02;  // by which the stated bound may exceed the largest distance
constexpr int kMostDivisions = 10'000;  // of triangles, in all; after that the bound is coarser, and still a bound
constexpr int kBatch = 32;              // of divisions side by side

using Triangle = std::array<Vec3, 3>;

Triangle triangle_of(const Mesh& mesh, int face) {
  const auto& f = mesh.faces[at(face)];
  return {mesh.vertices[at(f[0])], mesh.vertices[at(f[1])], mesh.vertices[at(f[2])]};
}

double area_of(const Triangle& t) {
  return 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
}

// Corner places of a face in a fixed order: equal for the same triangle of two meshes.
using Key = std::array<std::array<double, 3>, 3>;
Key key_of(const Triangle& t) {
  Key key;
  for (std::size_t k = 0; k < 3; ++k) key[k] = {t[k].x(), t[k].y(), t[k].z()};
  std::ranges::sort(key);
  return key;
}

// Of the distances of one triangle's points: a bound, a distance that one of them has and which, that of its middle.
struct Bounds {
  double upper = 0.0, lower = 0.0, middle = 0.0;
  Vec3 lower_at = Vec3::Zero();
};

class OneWay {
 public:
  explicit OneWay(const Mesh& to) : to_(unshared(to)) {
    for (int f = 0; f < static_cast<int>(to.faces.size()); ++f) same_.insert(key_of(triangle_of(to, f)));
  }

  // Of the faces that `wanted` names; the same triangle of both is at distance 0.
  void measure(const Mesh& from, const std::vector<bool>& wanted) {
    std::vector<int> changed;
    for (int f = 0; f < static_cast<int>(from.faces.size()); ++f) {
      const Triangle t = triangle_of(from, f);
      area_ += wanted[at(f)] ? area_of(t) : 0.0;
      if (wanted[at(f)] && !same_.contains(key_of(t))) changed.push_back(f);
    }
    std::vector<Triangle> triangles;
    for (const int f : changed) triangles.push_back(triangle_of(from, f));
    const std::vector<Bounds> bounds = bounds_of(triangles);
    for (std::size_t k = 0; k < bounds.size(); ++k) sum_ += area_of(triangles[k]) * bounds[k].middle;
    search(triangles, bounds);
  }

  double largest = 0.0;
  Vec3 where = Vec3::Zero();
  [[nodiscard]] double mean() const { return area_ > 0.0 ? sum_ / area_ : 0.0; }

 private:
  [[nodiscard]] double distance_to_face(const Vec3& p, int face) const {
    const Triangle t = triangle_of(to_.mesh(), face);
    const Vec3 w = closest_on_triangle(p, t[0], t[1], t[2]);
    return (w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - p).norm();
  }

  [[nodiscard]] Bounds bounds_of(const Triangle& t) const {
    Bounds b{.upper = std::numeric_limits<double>::infinity()};
    std::array<SurfacePoint, 4> found;
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3& point = k < 3 ? t[k] : middle;
      found[k] = to_.closest(point);
      if (found[k].distance_mm < b.lower) continue;
      b.lower = found[k].distance_mm;
      b.lower_at = point;
    }
    for (const SurfacePoint& p : found) {
      double most = 0.0;
      for (const Vec3& corner : t) most = std::max(most, distance_to_face(corner, p.face));
      b.upper = std::min(b.upper, most);
    }
    double radius = 0.0;
    for (const Vec3& corner : t) radius = std::max(radius, (corner - middle).norm());
    b.middle = found[3].distance_mm;
    b.upper = std::min(b.upper, b.middle + radius);
    return b;
  }
  [[nodiscard]] std::vector<Bounds> bounds_of(const std::vector<Triangle>& triangles) const {
    std::vector<Bounds> bounds(triangles.size());
    tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t k) { bounds[k] = bounds_of(triangles[k]); });
    return bounds;
  }

  // Branch and bound over all triangles: the one with the largest bound is divided, until no bound is above a distance
  // that is known to occur.
  void search(const std::vector<Triangle>& triangles, const std::vector<Bounds>& bounds) {
    using Open = std::pair<double, Triangle>;
    const auto less = [](const Open& a, const Open& b) { return a.first < b.first; };
    std::priority_queue<Open, std::vector<Open>, decltype(less)> open(less);
    double known = 0.0, bound = 0.0;
    Vec3 known_at = Vec3::Zero();
    const auto take = [&](const std::vector<Triangle>& parts, const std::vector<Bounds>& of_parts) {
      for (const Bounds& b : of_parts) {
        if (b.lower <= known) continue;
        known = b.lower;
        known_at = b.lower_at;
      }
      for (std::size_t k = 0; k < parts.size(); ++k) {
        if (of_parts[k].upper > known + kTolerance_mm)
          open.emplace(of_parts[k].upper, parts[k]);
        else
          bound = std::max(bound, of_parts[k].upper);
      }
    };
    take(triangles, bounds);
    for (int divisions = 0; divisions < kMostDivisions;) {
      std::vector<Triangle> parts;
      for (int k = 0; k < kBatch && !open.empty() && open.top().first > known + kTolerance_mm; ++k, ++divisions) {
        const Triangle t = open.top().second;
        open.pop();
        const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
        parts.insert(parts.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
      }
      if (parts.empty()) break;
      take(parts, bounds_of(parts));
    }
    if (!open.empty()) bound = std::max(bound, open.top().first);
    if (bound <= largest) return;
    largest = bound;
    where = known_at;
  }

  Surface to_;
  std::set<Key> same_;
  double sum_ = 0.0, area_ = 0.0;
};

}  // namespace

Deviation deviation_between(const Mesh& input, const std::vector<bool>& outside, const Mesh& result) {
  OneWay there(result), back(input);
  there.measure(input, outside);
  back.measure(result, std::vector<bool>(result.faces.size(), true));
  Deviation d{back.mean(), back.largest, back.where};
  if (there.largest > d.largest_mm) {
    d.largest_mm = there.largest;
    d.where_mm = there.where;
  }
  d.mean_mm = std::max(d.mean_mm, there.mean());
  return d;
}

}  // namespace triskin::geometry
