// SPDX-License-Identifier: GPL-3.0-or-later
#include "ring_rules.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "triskin/base/error.hpp"

namespace triskin::check {
namespace {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = ExactKernel::Point_2;
using Segment = ExactKernel::Segment_2;
using Outline = CGAL::Polygon_2<ExactKernel>;

constexpr double kMaxCoordinate_mm = 1e8;

class ValidRings {
 public:
  ValidRings(const std::vector<Ring>& rings, const std::string& name) : name_(name) {
    for (std::size_t r = 0; r < rings.size(); ++r) add(rings[r], r);
  }

  void require() {
    for (std::size_t i = 0; i < edges_.size(); ++i)
      for (std::size_t k = i + 1; k < edges_.size(); ++k) compare(edges_[i], edges_[k]);
    for (std::size_t hole = 1; hole < outlines_.size(); ++hole) {
      if (has_part(hole, 0, CGAL::ON_UNBOUNDED_SIDE)) refuse(hole, "lies outside the outer ring");
      for (std::size_t other = 1; other < outlines_.size(); ++other) {
        if (other != hole && has_part(hole, other, CGAL::ON_BOUNDED_SIDE)) refuse(hole, "lies in another hole");
      }
    }
    require_tree();
  }

 private:
  struct Edge {
    Segment segment;
    CGAL::Bbox_2 box;
    std::size_t ring, index;
  };

  [[noreturn]] void refuse(std::size_t ring, const char* what) const {
    throw InputError(fmt::format("{}: ring {} {}: no polygon that \"triskin place\" accepts", name_, ring, what));
  }

  void add(const Ring& ring, std::size_t r) {
    if (ring.size() < 4 || ring.front() != ring.back()) refuse(r, "is not closed, or has fewer than three corners");
    Outline outline;
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      if (!(std::abs(ring[k][0]) <= kMaxCoordinate_mm && std::abs(ring[k][1]) <= kMaxCoordinate_mm))
        refuse(r, "has a coordinate beyond ±1e8 mm");
      if (ring[k] != ring[k + 1]) outline.push_back(ExactPoint(ring[k][0], ring[k][1]));
    }
    if (outline.size() < 3) refuse(r, "has fewer than three corners");
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const Segment s = outline.edge(k);
      edges_.push_back({s, s.bbox(), r, k});
    }
    outlines_.push_back(std::move(outline));
  }

  void compare(const Edge& e, const Edge& f) {
    if (!CGAL::do_overlap(e.box, f.box)) return;
    const auto common = CGAL::intersection(e.segment, f.segment);
    if (!common) return;
    const ExactPoint* point = boost::get<ExactPoint>(&*common);
    if (point == nullptr) refuse(f.ring, e.ring == f.ring ? "is traced twice" : "shares an edge with another ring");
    const auto is_end = [&](const Edge& g) { return *point == g.segment.source() || *point == g.segment.target(); };
    if (e.ring == f.ring) {
      const std::size_t n = outlines_[e.ring].size();
      const bool is_corner = is_end(e) && is_end(f) && ((e.index + 1) % n == f.index || (f.index + 1) % n == e.index);
      if (!is_corner) refuse(e.ring, "crosses or touches itself");
      return;
    }
    if (!is_end(e) && !is_end(f)) refuse(f.ring, "crosses another ring");
    meetings_[*point].insert(e.ring);
    meetings_[*point].insert(f.ring);
  }

  // Tells whether some part of `ring`, between two points where it meets `other`, is on that side of it.
  [[nodiscard]] bool has_part(std::size_t ring, std::size_t other, CGAL::Bounded_side side) const {
    return std::ranges::any_of(edges_, [&](const Edge& e) {
      if (e.ring != ring) return false;
      std::vector<ExactPoint> stops{e.segment.source(), e.segment.target()};
      for (const auto& [point, rings] : meetings_) {
        if (rings.contains(ring) && rings.contains(other) && e.segment.has_on(point)) stops.push_back(point);
      }
      std::ranges::sort(
          stops, [](const ExactPoint& a, const ExactPoint& b) { return CGAL::compare_xy(a, b) == CGAL::SMALLER; });
      for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
        if (outlines_[other].bounded_side(CGAL::midpoint(stops[k], stops[k + 1])) == side) return true;
      }
      return false;
    });
  }

  // Rings and the points where they meet are the nodes of a graph. The inside is connected if the graph has no cycle; a
  // walk that reaches a node a second time shows one.
  void require_tree() const {
    std::set<std::size_t> seen;
    for (std::size_t r = 0; r < outlines_.size(); ++r) {
      if (!seen.contains(r)) walk(r, nullptr, seen);
    }
  }
  void walk(std::size_t ring, const ExactPoint* from, std::set<std::size_t>& seen) const {
    if (!seen.insert(ring).second) refuse(ring, "cuts the polygon in two with others that it touches");
    for (const auto& [point, rings] : meetings_) {
      if (&point == from || !rings.contains(ring)) continue;
      for (const std::size_t next : rings) {
        if (next != ring) walk(next, &point, seen);
      }
    }
  }

  const std::string& name_;
  std::vector<Outline> outlines_;
  std::vector<Edge> edges_;
  std::map<ExactPoint, std::set<std::size_t>> meetings_;
};

}  // namespace

void require_valid_rings(const std::vector<Ring>& rings, const std::string& name) {
  ValidRings(rings, name).require();
}

}  // namespace triskin::check
