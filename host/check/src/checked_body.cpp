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

}  // namespace

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

// All points nearer to a point than its distance are on its side, so only few points need the inside test.
double CheckedBody::least_along(const P3& from, const P3& to) const {
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
