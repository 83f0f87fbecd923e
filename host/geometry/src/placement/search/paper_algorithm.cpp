// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/paper_algorithm.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>

#include <cmath>

namespace triskin::geometry {
namespace {

template <class Kernel>
class PaperAlgorithm {
 public:
  PaperAlgorithm(const Polygon& polygon, const Placement& at) {
    const typename Kernel::FT c = std::cos(at.theta_rad), s = std::sin(at.theta_rad), x = at.x_mm, y = at.y_mm;
    const auto move = [&](const std::vector<Vec2>& ring) {
      CGAL::Polygon_2<Kernel> moved;
      for (const Vec2& v : ring) moved.push_back(Point(c * v.x() - s * v.y() + x, s * v.x() + c * v.y() + y));
      return moved;
    };
    rings_.push_back(move(polygon.outer));
    for (const auto& hole : polygon.holes) rings_.push_back(move(hole));
  }

  int count() const {
    const auto box = rings_.front().bbox();
    int n = 0;
    for (int j = static_cast<int>(std::floor(box.ymin() / kHeight_mm)); j * kHeight_mm < box.ymax(); ++j) {
      const int first = static_cast<int>(std::floor(box.xmin() / kSide_mm - 0.5 * j)) - 1;
      for (int i = first; kSide_mm * (i + 0.5 * j) < box.xmax(); ++i) n += inside({i, j, true}) + inside({i, j, false});
    }
    return n;
  }

 private:
  using Point = typename Kernel::Point_2;
  using Segment = typename Kernel::Segment_2;

  int inside(const Tile& tile) const {
    std::array<Point, 3> t;
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = tile_corner_index(tile, k);
      const Vec2 q = grid_point(i, j);
      t[static_cast<std::size_t>(k)] = Point(q.x(), q.y());
    }
    if (!rings_.front().has_on_bounded_side(t[0])) return 0;
    for (std::size_t h = 1; h < rings_.size(); ++h) {
      if (rings_[h].has_on_bounded_side(t[0])) return 0;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Segment side(t[k], t[(k + 1) % 3]);
      for (const auto& ring : rings_) {
        for (auto e = ring.edges_begin(); e != ring.edges_end(); ++e) {
          if (CGAL::do_intersect(side, *e)) return 0;
        }
      }
    }
    return 1;
  }

  std::vector<CGAL::Polygon_2<Kernel>> rings_;
};

}  // namespace

int paper_algorithm1(const Polygon& polygon, const Placement& placement, bool exact_constructions) {
  if (exact_constructions) {
    return PaperAlgorithm<CGAL::Exact_predicates_exact_constructions_kernel>(polygon, placement).count();
  }
  return PaperAlgorithm<CGAL::Exact_predicates_inexact_constructions_kernel>(polygon, placement).count();
}

}  // namespace triskin::geometry
