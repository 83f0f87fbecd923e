// SPDX-License-Identifier: GPL-3.0-or-later
#include "polygon_rules.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "triskin/base/disjoint_sets.hpp"
#include "triskin/base/error.hpp"

namespace triskin::placement {
namespace {

using design::Polygon;
using design::Vec2;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_rational;
using Ring = std::vector<Vec2>;
using ExactPoint = std::array<Exact, 2>;

struct Edge {
  Vec2 a, b;
  std::size_t ring, vertex;
};

std::string ring_name(std::size_t ring) {
  return ring == 0 ? "outer ring" : fmt::format("hole {}", ring - 1);
}

int side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return CGAL::orientation(Kernel::Point_2(a.x(), a.y()), Kernel::Point_2(b.x(), b.y()), Kernel::Point_2(p.x(), p.y()));
}

bool is_before(const Vec2& p, const Vec2& q) {
  return std::pair(p.x(), p.y()) < std::pair(q.x(), q.y());
}

// Returns true if a point on the line of an edge lies on the edge.
bool is_within(const Edge& e, const Vec2& p) {
  const auto& [low, high] = is_before(e.a, e.b) ? std::pair(e.a, e.b) : std::pair(e.b, e.a);
  return !is_before(p, low) && !is_before(high, p);
}

ExactPoint exact(const Vec2& p) {
  return {Exact(p.x()), Exact(p.y())};
}

class Rules {
 public:
  Rules(const Polygon& polygon, const std::string& name) : polygon_(polygon), name_(name) {
    for (std::size_t r = 0; r <= polygon.holes.size(); ++r) {
      const Ring& points = ring(r);
      for (std::size_t v = 0; v < points.size(); ++v)
        edges_.push_back({points[v], points[(v + 1) % points.size()], r, v});
    }
  }

  void require() {
    compare_edges();
    for (std::size_t hole = 1; hole <= polygon_.holes.size(); ++hole) {
      if (!lies_inside(hole, 0)) fail(fmt::format("{} lies outside the outer ring", ring_name(hole)));
    }
    require_apart();
    require_connected();
  }

 private:
  [[nodiscard]] const Ring& ring(std::size_t r) const { return r == 0 ? polygon_.outer : polygon_.holes[r - 1]; }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}", name_, what)); }
  static std::string at(const Edge& e) {
    return fmt::format("the edge after vertex {} of the {}", e.vertex, ring_name(e.ring));
  }
  static std::string at(const Vec2& p) { return fmt::format("({:g}, {:g})", p.x(), p.y()); }

  void compare_edges() {
    std::ranges::sort(edges_, {}, [](const Edge& e) { return std::min(e.a.x(), e.b.x()); });
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const double right = std::max(edges_[i].a.x(), edges_[i].b.x());
      for (std::size_t k = i + 1; k < edges_.size() && std::min(edges_[k].a.x(), edges_[k].b.x()) <= right; ++k) {
        const bool is_first = std::pair(edges_[i].ring, edges_[i].vertex) < std::pair(edges_[k].ring, edges_[k].vertex);
        is_first ? compare(edges_[i], edges_[k]) : compare(edges_[k], edges_[i]);
      }
    }
  }

  void compare(const Edge& e, const Edge& f) {
    const auto [low, high] = std::minmax(e.a.y(), e.b.y());
    if (std::max(f.a.y(), f.b.y()) < low || std::min(f.a.y(), f.b.y()) > high) return;
    const int fa = side(e.a, e.b, f.a), fb = side(e.a, e.b, f.b);
    if (fa * fb > 0) return;
    const int ea = side(f.a, f.b, e.a), eb = side(f.a, f.b, e.b);
    if (ea * eb > 0) return;
    if (fa == 0 && fb == 0) return compare_on_one_line(e, f);
    if (fa * fb < 0 && ea * eb < 0)
      fail(fmt::format("{} crosses {}; the outline must not intersect itself", at(e), at(f)));
    const Vec2& point = fa == 0 ? f.a : fb == 0 ? f.b : ea == 0 ? e.a : e.b;
    const bool is_corner = e.ring == f.ring && follows(e, f);
    if (!is_corner) touch(e, f, point);
  }

  [[nodiscard]] bool follows(const Edge& e, const Edge& f) const {
    const std::size_t n = ring(e.ring).size();
    return (e.vertex + 1) % n == f.vertex || (f.vertex + 1) % n == e.vertex;
  }

  void compare_on_one_line(const Edge& e, const Edge& f) {
    std::vector<Vec2> shared;
    for (const Vec2& p : {f.a, f.b})
      if (is_within(e, p)) shared.push_back(p);
    for (const Vec2& p : {e.a, e.b})
      if (is_within(f, p) && std::ranges::find(shared, p) == shared.end()) shared.push_back(p);
    if (shared.empty()) return;
    if (shared.size() == 1) {
      if (e.ring != f.ring || !follows(e, f)) touch(e, f, shared.front());
      return;
    }
    if (e.ring != f.ring)
      fail(fmt::format("{} and {} lie on each other; draw each line once, and holes away from the outer ring", at(e),
                       at(f)));
    const char* what = follows(e, f) ? "goes back along" : "lies on";
    fail(fmt::format("{} {} {}: the ring is traced twice there; delete the doubled line", at(f), what, at(e)));
  }

  void touch(const Edge& e, const Edge& f, const Vec2& point) {
    if (e.ring == f.ring) {
      fail(fmt::format("the {} touches itself at {}, in {} and {}; split it into rings that do not", ring_name(e.ring),
                       at(point), at(e), at(f)));
    }
    touches_[exact(point)].insert({e.ring, f.ring});
    on_[{e.ring, e.vertex}].push_back({f.ring, point});
    on_[{f.ring, f.vertex}].push_back({e.ring, point});
  }

  // Returns 1 inside, 0 on, -1 outside a ring. Exact.
  [[nodiscard]] int place(const ExactPoint& p, std::size_t r) const {
    bool is_inside = false;
    const Ring& points = ring(r);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const ExactPoint a = exact(points[k]), b = exact(points[(k + 1) % points.size()]);
      const Exact turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
      if (turn == 0 && std::min(a, b) <= p && p <= std::max(a, b)) return 0;
      if ((a[1] > p[1]) != (b[1] > p[1]) && (turn > 0) == (b[1] > a[1])) is_inside = !is_inside;
    }
    return is_inside ? 1 : -1;
  }

  // Finds points of the ring `inner` that are not on the ring `outer`. Rings that do not cross lie on one side of each
  // other except where they touch, so each part between such points has one witness.
  [[nodiscard]] std::vector<ExactPoint> witnesses(std::size_t inner, std::size_t outer) const {
    std::vector<ExactPoint> points;
    const Ring& corners = ring(inner);
    for (std::size_t v = 0; v < corners.size(); ++v) {
      std::vector<ExactPoint> cuts{exact(corners[v]), exact(corners[(v + 1) % corners.size()])};
      const auto found = on_.find({inner, v});
      if (found != on_.end()) {
        for (const auto& [other, p] : found->second)
          if (other == outer) cuts.push_back(exact(p));
      }
      if (cuts.size() == 2 && !points.empty()) continue;  // Nothing has changed since the last witness.
      std::ranges::sort(cuts);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        if (cuts[k] != cuts[k + 1])
          points.push_back({(cuts[k][0] + cuts[k + 1][0]) / 2, (cuts[k][1] + cuts[k + 1][1]) / 2});
      }
    }
    return points;
  }
  [[nodiscard]] bool lies_inside(std::size_t inner, std::size_t outer) const {
    const auto points = witnesses(inner, outer);
    return std::ranges::all_of(points, [&](const ExactPoint& p) { return place(p, outer) > 0; });
  }

  // Compares holes in pairs whose boxes meet. Rings may also cross at their corners alone, so every part is tested.
  void require_apart() const {
    std::vector<Eigen::AlignedBox2d> boxes(polygon_.holes.size());
    for (std::size_t h = 0; h < boxes.size(); ++h)
      for (const Vec2& p : polygon_.holes[h]) boxes[h].extend(p);
    for (std::size_t a = 0; a < boxes.size(); ++a) {
      for (std::size_t b = 0; b < boxes.size(); ++b) {
        if (a == b || !boxes[a].intersects(boxes[b])) continue;
        const auto points = witnesses(b + 1, a + 1);
        if (std::ranges::any_of(points, [&](const ExactPoint& p) { return place(p, a + 1) > 0; }))
          fail(fmt::format("{} lies inside {}", ring_name(b + 1), ring_name(a + 1)));
      }
    }
  }

  // In the graph of rings and the points where they touch, a cycle cuts the inside in two.
  void require_connected() const {
    const std::size_t rings = polygon_.holes.size() + 1;
    DisjointSets sets(rings + touches_.size());
    std::size_t point = rings;
    for (const auto& [place, pairs] : touches_) {
      std::set<std::size_t> here;
      for (const auto& [a, b] : pairs) here.insert({a, b});
      for (const std::size_t r : here) {
        if (sets.find(static_cast<int>(r)) == sets.find(static_cast<int>(point))) {
          fail(
              fmt::format("the {} touches other rings so that they cut the polygon in two at ({:g}, {:g}); give each "
                          "part as a polygon of its own",
                          ring_name(r), CGAL::to_double(place[0]), CGAL::to_double(place[1])));
        }
        sets.join(static_cast<int>(r), static_cast<int>(point));
      }
      ++point;
    }
  }

  const Polygon& polygon_;
  const std::string& name_;
  std::vector<Edge> edges_;
  // The key is a point, the value the pairs of rings that meet there.
  std::map<ExactPoint, std::set<std::pair<std::size_t, std::size_t>>> touches_;
  // Lists the points of other rings on an edge, keyed by ring and vertex of the edge.
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::pair<std::size_t, Vec2>>> on_;
};

}  // namespace

void require_valid_polygon(const Polygon& polygon, const std::string& name) {
  Rules(polygon, name).require();
}

}  // namespace triskin::placement
