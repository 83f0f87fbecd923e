// SPDX-License-Identifier: GPL-3.0-or-later
// Distance between two sets of triangles with a proved upper bound: the distance to one triangle is convex, so over a
// triangle it is largest at a corner.
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>

#include "extract_steps.hpp"
#include "index.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {
namespace {

constexpr double kTolerance_mm = 0.02;  // by which the stated bound may exceed the largest distance
constexpr int kMostDivisions = 4000;    // of a face; after that the bound is coarser, and still a bound

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

// Of one triangle: the bound and where, and the distance of its middle.
struct Found {
  double most = 0.0, middle = 0.0;
  Vec3 where = Vec3::Zero();
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
    std::vector<Found> found(changed.size());
    tbb::parallel_for(std::size_t{0}, changed.size(),
                      [&](std::size_t k) { found[k].most = bounds(triangle_of(from, changed[k])).second; });
    double known = 0.0;
    for (const Found& f : found) known = std::max(known, f.most);
    tbb::parallel_for(std::size_t{0}, changed.size(),
                      [&](std::size_t k) { found[k] = search(triangle_of(from, changed[k]), known); });
    for (std::size_t k = 0; k < found.size(); ++k) {
      sum_ += area_of(triangle_of(from, changed[k])) * found[k].middle;
      if (found[k].most <= largest) continue;
      largest = found[k].most;
      where = found[k].where;
    }
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

  // Upper bound over the triangle, and a distance that one of its points has.
  [[nodiscard]] std::pair<double, double> bounds(const Triangle& t) const {
    double upper = std::numeric_limits<double>::infinity(), lower = 0.0;
    std::array<SurfacePoint, 4> found;
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    for (std::size_t k = 0; k < 4; ++k) {
      found[k] = to_.closest(k < 3 ? t[k] : middle);
      lower = std::max(lower, found[k].distance_mm);
    }
    for (const SurfacePoint& p : found) {
      double most = 0.0;
      for (const Vec3& corner : t) most = std::max(most, distance_to_face(corner, p.face));
      upper = std::min(upper, most);
    }
    double radius = 0.0;
    for (const Vec3& corner : t) radius = std::max(radius, (corner - middle).norm());
    return {std::min(upper, found[3].distance_mm + radius), lower};
  }

  // Divides the triangle until its bound is near a distance that is known to occur.
  [[nodiscard]] Found search(const Triangle& whole, double known) const {
    Found found{0.0, to_.closest((whole[0] + whole[1] + whole[2]) / 3.0).distance_mm, whole[0]};
    std::vector<Triangle> open{whole};
    int divisions = 0;
    while (!open.empty()) {
      const Triangle t = open.back();
      open.pop_back();
      const auto [upper, lower] = bounds(t);
      known = std::max(known, lower);
      if (upper <= known + kTolerance_mm || ++divisions > kMostDivisions) {
        if (upper > found.most) found = {upper, found.middle, (t[0] + t[1] + t[2]) / 3.0};
        continue;
      }
      const Vec3 ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
      for (const Triangle& part :
           {Triangle{t[0], ab, ca}, Triangle{ab, t[1], bc}, Triangle{ca, bc, t[2]}, Triangle{ab, bc, ca}})
        open.push_back(part);
    }
    return found;
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
