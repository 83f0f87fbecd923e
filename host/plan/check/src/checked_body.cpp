// SPDX-License-Identifier: GPL-3.0-or-later
#include "checked_body.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

namespace triskin::check {
namespace {

constexpr double kAlong_mm = 0.15;  // The checker samples other places along the normal than the solver.

// Squared distance of two segments: of their lines where both feet lie within, else of an end from the other segment.
double squared_between(const P3& a, const P3& b, const P3& c, const P3& d) {
  const auto to_segment = [](const P3& p, const P3& q, const P3& r) {
    const P3 along = r - q;
    const double square = along.squaredNorm();
    const double part = square > 0.0 ? std::clamp((p - q).dot(along) / square, 0.0, 1.0) : 0.0;
    return (p - q - part * along).squaredNorm();
  };
  const P3 u = b - a, v = d - c, w = a - c;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), det = uu * vv - uv * uv;
  if (det > 1e-12 * uu * vv) {
    const double s = (uv * v.dot(w) - vv * u.dot(w)) / det, t = (uu * v.dot(w) - uv * u.dot(w)) / det;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) return (w + s * u - t * v).squaredNorm();
  }
  return std::min({to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)});
}

P3 point_of(const auto& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace

// Visits the boxes of the tree that may hold something nearer to a segment than the best so far. CGAL's own queries
// know distances of points only.
class CheckedBody::NearSegment {
 public:
  NearSegment(const P3& from, const P3& to, double squared_bound)
      : from_(from), to_(to), low_(from.cwiseMin(to)), high_(from.cwiseMax(to)), best_(squared_bound) {}

  [[nodiscard]] double squared() const { return best_; }

  [[nodiscard]] bool go_further() const { return best_ > 0.0; }
  void intersection(const P3& /*query*/, const Primitive& primitive) {
    const auto& t = primitive.datum();
    const std::array corner{point_of(t[0]), point_of(t[1]), point_of(t[2])};
    if (passes(corner)) best_ = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      best_ = std::min(best_, squared_between(from_, to_, corner[k], corner[(k + 1) % 3]));
    for (const P3& end : {from_, to_}) best_ = std::min(best_, squared_above(end, corner));
  }
  template <typename Node>
  [[nodiscard]] bool do_intersect(const P3& /*query*/, const Node& node) const {
    const auto box = node.bbox();
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double gap = std::max({0.0, box.min(axis) - high_[axis], low_[axis] - box.max(axis)});
      squared += gap * gap;
    }
    return squared < best_;
  }

 private:
  using Corners = std::array<P3, 3>;
  [[nodiscard]] static bool is_over(const P3& p, const Corners& c, const P3& normal) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (normal.dot((c[(k + 1) % 3] - c[k]).cross(p - c[k])) < 0.0) return false;
    }
    return true;
  }
  // Infinite unless the point lies right above or below the triangle.
  [[nodiscard]] static double squared_above(const P3& p, const Corners& c) {
    const P3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    const double square = normal.squaredNorm();
    if (!(square > 0.0) || !is_over(p, c, normal)) return std::numeric_limits<double>::infinity();
    const double height = normal.dot(p - c[0]);
    return height * height / square;
  }
  [[nodiscard]] bool passes(const Corners& c) const {
    const P3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    const double a = normal.dot(from_ - c[0]), b = normal.dot(to_ - c[0]);
    if (a * b > 0.0 || a == b) return false;
    return is_over(from_ + a / (a - b) * (to_ - from_), c, normal);
  }

  P3 from_, to_, low_, high_;
  double best_;
};

CheckedBody::CheckedBody(const std::vector<P3>& vertices, const std::vector<std::array<int, 3>>& faces) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& f : faces) {
    const auto corner = [&](std::size_t k) {
      const P3& p = vertices[static_cast<std::size_t>(f[k])];
      return Kernel::Point_3(p.x(), p.y(), p.z());
    };
    triangles_.emplace_back(corner(0), corner(1), corner(2));
    for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(f[k], f[(k + 1) % 3])];
  }
  is_closed_ = std::ranges::none_of(uses, [](const auto& edge) { return edge.second % 2 != 0; });
  tree_.insert(triangles_.cbegin(), triangles_.cend());
  tree_.build();
  tree_.accelerate_distance_queries();
}

// A ray counts +1 when it leaves and −1 when it enters, so overlapping bodies count as one.
bool CheckedBody::is_inside(const P3& p, const Kernel::Vector_3& ray) const {
  std::vector<Triangles::const_iterator> met;
  tree_.all_intersected_primitives(Kernel::Ray_3(Kernel::Point_3(p.x(), p.y(), p.z()), ray), std::back_inserter(met));
  int sum = 0;
  for (const auto& triangle : met) {
    const auto normal = CGAL::cross_product((*triangle)[1] - (*triangle)[0], (*triangle)[2] - (*triangle)[0]);
    sum += normal * ray > 0.0 ? 1 : -1;
  }
  return sum != 0;
}

bool CheckedBody::contains(const P3& p) const {
  if (!is_closed_) return false;
  const int inside = (is_inside(p, {0.31, 0.87, -0.41}) ? 1 : 0) + (is_inside(p, {-0.73, 0.19, 0.61}) ? 1 : 0) +
                     (is_inside(p, {0.09, -0.53, 0.83}) ? 1 : 0);
  return inside >= 2;
}

double CheckedBody::distance(const P3& from, const P3& to) const {
  const P3 middle = (from + to) / 2.0;
  NearSegment near(from, to, tree_.squared_distance(Kernel::Point_3(middle.x(), middle.y(), middle.z())));
  tree_.traversal(middle, near);
  return std::sqrt(near.squared());
}

// Outside of the body the distance is exact, and one query gives it. Only a segment that reaches into the body is
// sampled. All points nearer to a point than its distance are on its side, so only few points need the inside test.
double CheckedBody::least_along(const P3& from, const P3& to) const {
  if (const double outside = distance(from, to); outside > 0.0 && !contains(from)) return outside;
  const double length = (to - from).norm();
  const P3 step = length > 0.0 ? P3((to - from) / length) : P3(P3::Zero());
  double least = std::numeric_limits<double>::infinity(), t = 0.0;
  bool inside = contains(from);
  while (true) {
    const P3 p = from + t * step;
    const double distance = std::sqrt(tree_.squared_distance(Kernel::Point_3(p.x(), p.y(), p.z())));
    const double here = inside ? -distance : distance;
    least = std::min(least, here);
    if (!(t < length)) return least;
    const double ahead = std::min(length - t, std::max(kAlong_mm, here - least));
    t = ahead < length - t ? t + ahead : length;
    if (!(ahead < distance)) inside = contains(from + t * step);
  }
}

}  // namespace triskin::check
