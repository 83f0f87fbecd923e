// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>

#include <algorithm>
#include <array>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::test {

/// Counts the tiles of a placement one by one in exact arithmetic, without code of any evaluator. A tile that touches
/// the outline counts as cut, so it is meant for generic placements.
class ExactCount {
 public:
  ExactCount(const design::Polygon& p, const design::Placement& at) {
    const double c = std::cos(at.theta_rad), s = std::sin(at.theta_rad);
    const auto ring = [&](const std::vector<design::Vec2>& points) {
      Ring r;
      for (const auto& v : points) r.push_back(Point(c * v.x() - s * v.y() + at.x_mm, s * v.x() + c * v.y() + at.y_mm));
      return r;
    };
    outer_ = ring(p.outer);
    for (const auto& hole : p.holes) holes_.push_back(ring(hole));
  }

  /// Returns the tiles sorted.
  [[nodiscard]] std::vector<design::Tile> tiles() const {
    using namespace placement;
    const auto box = outer_.bbox();
    std::vector<design::Tile> found;
    for (int j = static_cast<int>(std::floor(box.ymin() / design::kHeight_mm)) - 1; j * design::kHeight_mm < box.ymax();
         ++j) {
      const int first = static_cast<int>(std::floor(box.xmin() / design::kSide_mm - 0.5 * j)) - 2;
      for (int i = first; design::kSide_mm * (i + 0.5 * j) < box.xmax(); ++i) {
        for (const bool up : {true, false}) {
          if (inside({i, j, up})) found.push_back({i, j, up});
        }
      }
    }
    std::ranges::sort(found);
    return found;
  }

 private:
  using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
  using Point = Exact::Point_2;
  using Ring = CGAL::Polygon_2<Exact>;

  // Requires that no edge of any ring touches the tile, and that its centre is in the outer ring and in no hole.
  [[nodiscard]] bool inside(const design::Tile& tile) const {
    std::array<Point, 3> t;
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = design::tile_corner_index(tile, k);
      const design::Vec2 q = design::grid_point(i, j);
      t[static_cast<std::size_t>(k)] = Point(q.x(), q.y());
    }
    const Exact::Triangle_2 triangle(t[0], t[1], t[2]);
    const auto touches = [&](const Ring& ring) {
      return std::any_of(ring.edges_begin(), ring.edges_end(),
                         [&](const auto& e) { return CGAL::do_intersect(triangle, e); });
    };
    const Point center = CGAL::centroid(t[0], t[1], t[2]);
    if (touches(outer_) || !outer_.has_on_bounded_side(center)) return false;
    return std::ranges::none_of(holes_, [&](const auto& h) { return touches(h) || h.has_on_bounded_side(center); });
  }

  Ring outer_;
  std::vector<Ring> holes_;
};

}  // namespace triskin::test
