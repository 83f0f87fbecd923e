// SPDX-License-Identifier: GPL-3.0-or-later
#include "flat_edges.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>

namespace triskin::check {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

CGAL::Orientation turn(const P2& a, const P2& b, const P2& c) {
  return CGAL::orientation(Point(a.x(), a.y()), Point(b.x(), b.y()), Point(c.x(), c.y()));
}

// Returns true if a side of `s` has all of `t` on its outer side.
bool is_separated_by_a_side(const std::vector<P2>& s, const std::vector<P2>& t) {
  for (std::size_t k = 0; k < s.size(); ++k) {
    const P2 &a = s[k], &b = s[(k + 1) % s.size()];
    if (std::ranges::all_of(t, [&](const P2& q) { return turn(a, b, q) != CGAL::LEFT_TURN; })) return true;
  }
  return false;
}

}  // namespace

void add_ring(const std::vector<P2>& ring, std::vector<FlatEdge>& edges) {
  for (std::size_t k = 0; k < ring.size(); ++k) edges.push_back({ring[k], ring[(k + 1) % ring.size()]});
}

bool do_cross(const FlatEdge& one, const FlatEdge& other) {
  return turn(one.a, one.b, other.a) * turn(one.a, one.b, other.b) < 0 &&
         turn(other.a, other.b, one.a) * turn(other.a, other.b, one.b) < 0;
}

bool is_inside(const P2& q, const std::vector<FlatEdge>& edges) {
  bool in = false;
  for (const FlatEdge& e : edges) {
    if ((e.a.y() > q.y()) != (e.b.y() > q.y()) && (turn(e.a, e.b, q) == CGAL::LEFT_TURN) == (e.b.y() > e.a.y()))
      in = !in;
  }
  return in;
}

bool is_free_of(const std::vector<P2>& t, const FlatEdge& e) {
  int left = 0, right = 0;
  for (const P2& q : t) {
    const int side = turn(e.a, e.b, q);
    left += side > 0 ? 1 : 0;
    right += side < 0 ? 1 : 0;
  }
  return left == 0 || right == 0 || is_separated_by_a_side(t, {e.a, e.b});
}

bool are_apart(const std::vector<P2>& s, const std::vector<P2>& t) {
  return is_separated_by_a_side(s, t) || is_separated_by_a_side(t, s);
}

}  // namespace triskin::check
