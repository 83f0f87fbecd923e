// SPDX-License-Identifier: GPL-3.0-or-later
// Why the change is a bound: both sets of faces are graphs over the plane, of functions that are linear on the parts
// into which the edges of both divide it. So is their difference, which is therefore largest at a corner of such a
// part: at the middle, or where an old edge crosses a new one. At a border the two planes' regions differ by the
// triangle of the two old border edges and the new one; no point of that is farther from the new edge, or from the old
// ones, than the middle is from the new edge, and the faces over it differ from it as above.
#include "flat_star.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/geometry/segment.hpp"

namespace triskin::mesh {
namespace {

constexpr double kNeedle = 0.03;  // The ratio is height over longest edge; new faces may be worse only if old ones are.
// The cosine is between a face and the mean normal; new faces may be worse only if old ones are.
constexpr double kLean = 0.5;

double squared(const auto& a, const auto& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z);
}

}  // namespace

FlatStar::FlatStar(const Vec3& middle, std::span<const Vec3> ring, bool is_open)
    : size_(ring.size()), is_open_(is_open) {
  std::array<Vec3, kMaxCorners> spoke;
  for (std::size_t k = 0; k < size_; ++k) spoke[k] = ring[k] - middle;
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < faces(); ++k) sum += spoke[k].cross(spoke[next(k)]);
  const Vec3 normal = sum.normalized(), x = (spoke[0] - spoke[0].dot(normal) * normal).normalized(),
             y = normal.cross(x);
  for (std::size_t k = 0; k < size_; ++k) ring_[k] = {x.dot(spoke[k]), y.dot(spoke[k]), normal.dot(spoke[k])};
  if (is_open) {
    border_mm_ = geometry::distance_to_segment(middle, ring[0], ring[size_ - 1]);
    ring_[0].y = 0.0;  // The walk of turns_once() begins on this axis.
  }
  for (std::size_t k = 0; k < faces(); ++k) {
    const Face face = face_of({0.0, 0.0, 0.0}, ring_[k], ring_[next(k)]);
    if (!(face.lean > 0.0)) return;
    old_shape_ = std::min(old_shape_, face.shape);
    old_lean_ = std::min(old_lean_, face.lean);
  }
  is_flat_ = turns_once();
}

double FlatStar::twice_area(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

FlatStar::Face FlatStar::face_of(const Corner& a, const Corner& b, const Corner& c) {
  const double nx = (b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y),
               ny = (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z), nz = twice_area(a, b, c);
  const double area = std::sqrt(nx * nx + ny * ny + nz * nz);
  const double longest = std::max({squared(a, b), squared(b, c), squared(c, a)});
  if (!(area > 0.0)) return {0.0, 0.0};
  return {area / longest, nz / area};
}

// Every step from one neighbour to the next is a left turn of less than half a circle, so each upward crossing of the x
// axis is one more round. An open star begins on it.
bool FlatStar::turns_once() const {
  int rounds = 0;
  for (std::size_t k = 0; k < faces(); ++k) rounds += ring_[k].y < 0.0 && ring_[next(k)].y >= 0.0 ? 1 : 0;
  return rounds == (is_open_ ? 0 : 1);
}

bool FlatStar::is_beside(std::size_t j, std::size_t k) const {
  const std::size_t low = std::min(j, k), high = std::max(j, k);
  return high - low == 1 || (!is_open_ && low == 0 && high == size_ - 1);
}

// A simple closed ring that is filled by faces of positive area is filled once. The faces of an open one must not go
// round its corner.
std::optional<double> FlatStar::worst_new_shape(std::size_t j) const {
  const Corner& v = ring_[j];
  double worst = 1.0;
  const Corner* first = nullptr;
  double before = 0.0;
  for (std::size_t k = 0; k < faces(); ++k) {
    if (k == j || next(k) == j) continue;
    const Corner &a = ring_[k], &b = ring_[next(k)];
    const Face face = face_of(v, a, b);
    if (face.lean < std::min(kLean, 0.9 * old_lean_) || face.shape < std::min(kNeedle, old_shape_)) return std::nullopt;
    worst = std::min(worst, face.shape);
    if (!is_open_) continue;
    if (first == nullptr) first = &a;
    const double side = twice_area(v, *first, b);
    if (before < 0.0 && side >= 0.0) return std::nullopt;
    before = side;
  }
  return worst;
}

std::optional<FlatStar::Change> FlatStar::onto(std::size_t j) const {
  const std::optional<double> shape = worst_new_shape(j);
  if (!shape) return std::nullopt;
  return Change{between(j) + border_mm_, border_mm_, *shape};
}

double FlatStar::between(std::size_t j) const {
  double most = at_middle(j);
  for (std::size_t q = 0; q < size_; ++q) {
    if (q != j && !is_beside(j, q)) most = std::max(most, at_crossings(j, q));
  }
  return most;
}

// Returns the height of the new face under or over the middle; beyond a border there is none.
double FlatStar::at_middle(std::size_t j) const {
  const Corner& v = ring_[j];
  double height = 0.0, best = is_open_ ? 0.0 : -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < faces(); ++k) {
    if (k == j || next(k) == j) continue;
    const Corner &a = ring_[k], &b = ring_[next(k)];
    const double at_a = b.x * v.y - b.y * v.x, at_b = v.x * a.y - v.y * a.x, at_v = a.x * b.y - a.y * b.x;
    const double sum = at_a + at_b + at_v, inside = std::min(at_a, at_b) / sum;
    if (inside < best) continue;
    best = inside;
    height = std::abs(at_a * a.z + at_b * b.z + at_v * v.z) / sum;
  }
  return height;
}

// Returns the largest height difference at which the new edge from j to q crosses old ones.
double FlatStar::at_crossings(std::size_t j, std::size_t q) const {
  const Corner &v = ring_[j], &w = ring_[q];
  double most = 0.0;
  for (std::size_t k = 0; k < size_; ++k) {
    if (k == j || k == q) continue;
    const Corner& p = ring_[k];
    const double side_v = p.x * v.y - p.y * v.x, side_w = p.x * w.y - p.y * w.x;
    if (side_v * side_w > 0.0 || side_v == side_w) continue;
    const double t = side_v / (side_v - side_w);
    const double along = (v.x + t * (w.x - v.x)) * p.x + (v.y + t * (w.y - v.y)) * p.y;
    const double s = along / (p.x * p.x + p.y * p.y);
    if (s < 0.0 || s > 1.0) continue;
    most = std::max(most, std::abs(s * p.z - v.z - t * (w.z - v.z)));
  }
  return most;
}

}  // namespace triskin::mesh
