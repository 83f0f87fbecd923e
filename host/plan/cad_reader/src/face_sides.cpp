// SPDX-License-Identifier: GPL-3.0-or-later
#include "face_sides.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace triskin::cad_reader {
namespace {

using design::Vec3;
using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr double kThickestWall_mm = 10.0;
constexpr double kStandOff_mm = 1e-3;  // Rays begin this far from their triangle.
constexpr int kRays = 16;
constexpr std::size_t kMaxPlaces = 12'000, kMaxPlacesAFace = 16, kMinPlacesAFace = 3;
// These are fractions of free rays: a difference below the first is not significant at 16 places of 16 rays.
constexpr double kClearDifference = 0.1, kMostlyFree = 0.5, kMostlyHidden = 0.3;
constexpr double kClearBulge_rad = 0.02;

struct Place {
  Vec3 at, normal;
  double free = 0.0;  // This fraction of its rays is free.
  /// The triangle belongs to the other sheet; −1 if there is none.
  design::FaceIndex behind = design::FaceIndex::none();
};
struct FaceView {
  std::vector<Place> places;
  double free = 0.0;
  double bulge_rad = 0.0;  // Positive if the normals spread.
};

Kernel::Point_3 point(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

class SideFinder {
 public:
  explicit SideFinder(const cad::Part& part) : part_(part) {
    for (const auto& f : part.mesh.faces) triangles_.emplace_back(corner(f, 0), corner(f, 1), corner(f, 2));
    tree_.rebuild(triangles_.begin(), triangles_.end());
    views_.resize(part.faces.size());
    collect_places();
    for (FaceView& view : views_) look(view);
  }

  [[nodiscard]] cad::FaceSide side_of(std::size_t face) const {
    const FaceView& view = views_[face];
    if (view.places.empty()) return cad::FaceSide::kUndecided;
    double other = 0.0, walls = 0.0;
    for (const Place& place : view.places) {
      if (place.behind < 0) continue;
      other += views_[static_cast<std::size_t>(part_.face_of_triangle[static_cast<std::size_t>(place.behind)])].free;
      walls += 1.0;
    }
    if (walls < 0.5 * static_cast<double>(view.places.size())) return alone(view);
    const double difference = view.free - other / walls;
    if (difference > kClearDifference) return cad::FaceSide::kOutward;
    if (difference < -kClearDifference) return cad::FaceSide::kInward;
    if (std::abs(view.bulge_rad) < kClearBulge_rad) return cad::FaceSide::kUndecided;
    return view.bulge_rad > 0.0 ? cad::FaceSide::kOutward : cad::FaceSide::kInward;
  }

 private:
  static cad::FaceSide alone(const FaceView& view) {
    if (view.free > kMostlyFree) return cad::FaceSide::kOutward;
    return view.free < kMostlyHidden ? cad::FaceSide::kInward : cad::FaceSide::kUndecided;
  }
  [[nodiscard]] Kernel::Point_3 corner(const std::array<int, 3>& f, std::size_t k) const {
    return point(part_.mesh.vertices[static_cast<std::size_t>(f[k])]);
  }

  // Triangles at even steps of the area represent their face.
  void collect_places() {
    std::vector<std::vector<std::pair<double, design::FaceIndex>>> by_face(part_.faces.size());
    for (std::size_t t = 0; t < part_.mesh.faces.size(); ++t)
      by_face[static_cast<std::size_t>(part_.face_of_triangle[t])].emplace_back(std::sqrt(triangles_[t].squared_area()),
                                                                                t);
    const std::size_t wanted =
        std::clamp(kMaxPlaces / std::max<std::size_t>(1, by_face.size()), kMinPlacesAFace, kMaxPlacesAFace);
    for (std::size_t f = 0; f < by_face.size(); ++f) {
      double total = 0.0, sum = 0.0;
      for (const auto& [area, t] : by_face[f]) total += area;
      for (const auto& [area, t] : by_face[f]) {
        const double before = std::floor(sum / total * static_cast<double>(wanted));
        sum += area;
        if (std::floor(sum / total * static_cast<double>(wanted)) > before) views_[f].places.push_back(place_on(t));
      }
    }
  }
  [[nodiscard]] Place place_on(design::FaceIndex t) const {
    const auto& f = part_.mesh.faces[static_cast<std::size_t>(t)];
    const auto at = [&](std::size_t k) { return part_.mesh.vertices[static_cast<std::size_t>(f[k])]; };
    return {(at(0) + at(1) + at(2)) / 3.0, (at(1) - at(0)).cross(at(2) - at(0)).normalized()};
  }

  void look(FaceView& view) {
    for (Place& place : view.places) {
      place.free = free_share(place);
      place.behind = behind(place);
      view.free += place.free / static_cast<double>(view.places.size());
    }
    view.bulge_rad = bulge(view.places);
  }
  // Uses the same cosine-weighted directions on a spiral for every place.
  [[nodiscard]] double free_share(const Place& place) const {
    const Vec3 x = place.normal.unitOrthogonal(), y = place.normal.cross(x);
    const Kernel::Point_3 from = point(place.at + kStandOff_mm * place.normal);
    int free = 0;
    for (int k = 0; k < kRays; ++k) {
      const double r2 = (k + 0.5) / kRays, turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
      const Vec3 d = std::sqrt(r2) * (std::cos(turn) * x + std::sin(turn) * y) + std::sqrt(1.0 - r2) * place.normal;
      if (!tree_.do_intersect(Kernel::Ray_3(from, Kernel::Vector_3(d.x(), d.y(), d.z())))) ++free;
    }
    return static_cast<double>(free) / kRays;
  }
  // Finds the other sheet of a thin wall: close behind the place, with its normal turned away.
  [[nodiscard]] design::FaceIndex behind(const Place& place) const {
    const Kernel::Segment_3 ray(point(place.at - kStandOff_mm * place.normal),
                                point(place.at - kThickestWall_mm * place.normal));
    std::vector<Primitive::Id> hits;
    tree_.all_intersected_primitives(ray, std::back_inserter(hits));
    double nearest = 1e300;
    design::FaceIndex found = design::FaceIndex::none();
    for (const auto& hit : hits) {
      const design::FaceIndex t(hit - triangles_.begin());
      const Place other = place_on(t);
      const double distance = (place.at - other.at).dot(place.normal);
      if (distance > 0.0 && distance < nearest) nearest = distance, found = t;
    }
    return found >= 0 && place_on(found).normal.dot(place.normal) < -0.5 ? found : design::FaceIndex::none();
  }
  // Returns the mean angle by which normals of two places spread: positive on the outside of a tube.
  static double bulge(const std::vector<Place>& places) {
    double sum = 0.0, pairs = 0.0;
    for (std::size_t a = 0; a < places.size(); ++a) {
      for (std::size_t b = a + 1; b < places.size(); ++b) {
        const Vec3 apart = places[b].at - places[a].at;
        if (!(apart.norm() > 0.0)) continue;
        sum += (places[b].normal - places[a].normal).dot(apart.normalized());
        pairs += 1.0;
      }
    }
    return pairs > 0.0 ? sum / pairs : 0.0;
  }

  const cad::Part& part_;
  Triangles triangles_;
  Tree tree_;
  std::vector<FaceView> views_;
};

}  // namespace

void decide_sides(cad::Part& part) {
  if (part.mesh.faces.empty()) return;
  const SideFinder finder(part);
  for (std::size_t f = 0; f < part.faces.size(); ++f) part.faces[f].side = finder.side_of(f);
}

}  // namespace triskin::cad_reader
