// SPDX-License-Identifier: GPL-3.0-or-later
// Implements Algorithm 1 of the paper (Section IV-B) line by line, with CGAL as its authors did (Section VI).
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "paper/grid_frame.hpp"
#include "paper/pierced.hpp"
#include "paper/side_marks.hpp"
#include "triskin/placement/paper/algorithm1.hpp"

namespace triskin::placement::paper {
namespace {

template <class Kernel>
class LineByLine {
 public:
  LineByLine(const Polygon& polygon, const PivotedPlacement& at, bool sides_first, const Algorithm1Options& options)
      : frame_(polygon, options.touch_mm), options_(options), sides_first_(sides_first), touch_(frame_.touch_along()) {
    frame_.move(at);
    marks_.reset(frame_);
    for (std::size_t ring = 0; ring < frame_.rings(); ++ring)
      place(ring == 0 ? polygon.outer : polygon.holes[ring - 1], polygon, at);
  }

  std::vector<Tile> patch() {
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
      set_direction(direction);
      for (int line = first_line_; line <= last_line_; ++line) evaluate_line(direction, line);
    }
    if (options_.reject_pierced) reject_pierced(frame_, marks_);
    return marks_.contained();
  }

 private:
  using Number = typename Kernel::FT;
  using Point = typename Kernel::Point_2;
  using Line = typename Kernel::Line_2;
  using Segment = typename Kernel::Segment_2;
  using Stretch = std::pair<Point, Point>;  // The stretch runs along the line, from left to right.

  // Applies the placement in the numbers of the kernel, as coordinates (u, v) of the grid.
  void place(const std::vector<Vec2>& ring, const Polygon& polygon, const PivotedPlacement& at) {
    const Vec2 pivot = at.vertex < 0 ? Vec2(0, 0) : polygon.outer[static_cast<std::size_t>(at.vertex)];
    const Number c = std::cos(at.theta_rad), s = std::sin(at.theta_rad), px = pivot.x(), py = pivot.y(),
                 to_x = px + Number(at.x_mm), to_y = py + Number(at.y_mm), side = kSide_mm, height = kHeight_mm;
    for (const Vec2& vertex : ring) {
      const Number dx = vertex.x() - px, dy = vertex.y() - py;
      const Number x = c * dx - s * dy + to_x, v = (s * dx + c * dy + to_y) / height;
      v_.push_back(v);
      u_.push_back(x / side - v / 2);
    }
  }

  // A vertex nearer to a line than the touching distance is moved onto it.
  [[nodiscard]] Number laid(const Number& across) const {
    const Number line = std::nearbyint(CGAL::to_double(across));
    return CGAL::abs(across - line) <= frame_.touch_across() ? line : across;
  }

  // The plane is turned and sheared so that the lines of this direction are level and their nodes have whole numbers.
  void set_direction(std::size_t direction) {
    points_.clear();
    for (std::size_t k = 0; k < u_.size(); ++k) {
      const Number &u = u_[k], &v = v_[k];
      points_.emplace_back(laid(direction == 0 ? u : v), laid(direction == 0 ? v : direction == 1 ? u : Number(u + v)));
    }
    const auto [low, high] = std::ranges::minmax(frame_.across(direction));
    const auto [left, right] = std::ranges::minmax(frame_.along(direction));
    first_line_ = static_cast<int>(std::ceil(low));
    last_line_ = static_cast<int>(std::floor(high));
    first_node_ = static_cast<int>(std::floor(left));
    last_node_ = static_cast<int>(std::ceil(right));
  }

  void evaluate_line(std::size_t direction, int number) {
    const Line line(Point(0, number), Point(1, number));
    cutting_.clear();
    contained_.clear();
    for (std::size_t ring = 0; ring < frame_.rings(); ++ring)
      intersect(line, frame_.ring_begin(ring), frame_.ring_begin(ring + 1));
    std::ranges::sort(cutting_, [](const Stretch& a, const Stretch& b) { return a < b; });
    const bool whole = options_.sides == ContainedSides::kDefinition5;
    for (std::size_t k = 0; k + 1 < cutting_.size(); k += 2) {
      const Stretch &begin = cutting_[k], &end = cutting_[k + 1];
      contained_.emplace_back(whole ? begin.first : begin.second, whole ? end.second : end.first);
    }
    for (const Stretch& segment : contained_) {
      for (int at = first_node_; at < last_node_; ++at) {
        if (segment.first.x() <= at + touch_ && segment.second.x() >= at + 1 - touch_)
          marks_.mark(direction, number, at);
      }
    }
  }

  // Applies Definition 6 to one ring: computes all intersections with the line and sorts them out by the half planes of
  // the vertices before and after; also takes the edges on the line.
  void intersect(const Line& line, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t next = k + 1 == last ? first : k + 1;
      const Point &p = points_[k], &q = points_[next];
      if (sides_first_ && line.oriented_side(p) == line.oriented_side(q)) continue;
      const Segment edge(p, q);
      if (!CGAL::do_intersect(line, edge)) continue;
      const CGAL::Oriented_side from = line.oriented_side(p);
      if (from == CGAL::ON_ORIENTED_BOUNDARY) continue;  // This vertex belongs to a stretch that began earlier.
      if (line.oriented_side(q) == CGAL::ON_ORIENTED_BOUNDARY) {
        visit_stretch(line, first, last, next, from);
        continue;
      }
      const auto met = CGAL::intersection(line, edge.supporting_line());
      if (const Point* at = boost::get<Point>(&*met)) cutting_.emplace_back(*at, *at);
    }
  }

  // Handles consecutive vertices on the line from `start` on; the one before is on side `from`.
  void visit_stretch(const Line& line, std::size_t first, std::size_t last, std::size_t start,
                     CGAL::Oriented_side from) {
    Stretch s{points_[start], points_[start]};
    for (std::size_t k = start;;) {
      const std::size_t next = k + 1 == last ? first : k + 1;
      const Point &p = points_[k], &q = points_[next];
      if (const CGAL::Oriented_side to = line.oriented_side(q); to != CGAL::ON_ORIENTED_BOUNDARY) {
        if (to != from) cutting_.push_back(s);
        break;
      }
      if (options_.sides == ContainedSides::kTheorem2) contained_.emplace_back(std::minmax(p, q));
      s = {std::min(s.first, q), std::max(s.second, q)};
      k = next;
    }
    if (options_.sides == ContainedSides::kDefinition5) contained_.push_back(s);
  }

  GridFrame frame_;  // The frame provides the window and everything that the paper does not define.
  const Algorithm1Options& options_;
  const bool sides_first_;
  const Number touch_;
  SideMarks marks_;
  int first_line_ = 0, last_line_ = 0, first_node_ = 0, last_node_ = 0;
  std::vector<Number> u_, v_;
  std::vector<Point> points_;
  std::vector<Stretch> cutting_, contained_;
};

}  // namespace

std::vector<Tile> algorithm1_cgal(const Polygon& polygon, const PivotedPlacement& placement, const CgalUse& use,
                                  const Algorithm1Options& options) {
  if (use.exact_constructions)
    return LineByLine<CGAL::Exact_predicates_exact_constructions_kernel>(polygon, placement, use.sides_first, options)
        .patch();
  return LineByLine<CGAL::Exact_predicates_inexact_constructions_kernel>(polygon, placement, use.sides_first, options)
      .patch();
}

}  // namespace triskin::placement::paper
