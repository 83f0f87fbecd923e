// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "checked_design.hpp"
#include "flat_edges.hpp"

namespace triskin::check {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;

Point pt(const P2& p) {
  return {p.x(), p.y()};
}
std::string piece_name(std::size_t k) {
  return "piece " + std::to_string(k);
}

double area_of(const std::vector<P2>& ring) {
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
    const P2 u = ring[k] - ring[0], v = ring[k + 1] - ring[0];
    twice += u.x() * v.y() - u.y() * v.x();
  }
  return twice / 2;
}

void check_scale(const CheckedDesign& d, std::size_t k, Findings& f) {
  const auto& p = d.pieces[k];
  double worst = 0.0, area = 0.0;
  for (std::size_t t = 0; t < p.faces.size(); ++t) {
    const auto& face = d.faces[static_cast<std::size_t>(p.faces[t])];
    if (CGAL::orientation(pt(p.flat[t][0]), pt(p.flat[t][1]), pt(p.flat[t][2])) != CGAL::LEFT_TURN) {
      f.broken("piece-flip", piece_name(k), fmt::format("the flat triangle of face {} is turned over", p.faces[t]));
    }
    for (std::size_t s = 0; s < 3; ++s) {
      const double real =
          (d.vertices[static_cast<std::size_t>(face[(s + 1) % 3])] - d.vertices[static_cast<std::size_t>(face[s])])
              .norm();
      worst = std::max(worst, std::abs((p.flat[t][(s + 1) % 3] - p.flat[t][s]).norm() / real - 1.0) * kSide);
    }
    area += area_of({p.flat[t].begin(), p.flat[t].end()});
  }
  if (!(std::abs(worst - p.max_edge_error) <= 1e-6)) {
    f.broken("piece-scale", piece_name(k),
             fmt::format("states an edge error of {:.4f} mm, has {:.4f} mm", p.max_edge_error, worst));
  }
  double outline = std::abs(area_of(p.outline));
  for (const auto& hole : p.holes) outline -= std::abs(area_of(hole));
  if (!(std::abs(outline - area) <= 1e-5 * area)) {
    f.broken("piece-overlap", piece_name(k),
             fmt::format("its triangles have {:.3f} mm², its outline holds {:.3f} mm²", area, outline));
  }
}

std::vector<FlatEdge> edges_of(const CheckedDesign::Piece& p) {
  std::vector<FlatEdge> edges;
  add_ring(p.outline, edges);
  for (const auto& hole : p.holes) add_ring(hole, edges);
  return edges;
}

void check_simple(const CheckedDesign::Piece& p, std::size_t k, Findings& f) {
  const auto edges = edges_of(p);
  for (std::size_t a = 0; a < edges.size(); ++a) {
    for (std::size_t b = a + 1; b < edges.size(); ++b) {
      if (do_cross(edges[a], edges[b])) f.broken("piece-simple", piece_name(k), "its outline crosses itself");
    }
  }
}

// Replaces each corner by two points, `cut` mm from it along its sides.
std::vector<P2> without_corners(const std::array<P2, 3>& t, double cut) {
  if (!(cut > 0.0)) return {t.begin(), t.end()};
  std::vector<P2> points;
  for (std::size_t k = 0; k < 3; ++k) {
    points.emplace_back(t[k] + cut * (t[(k + 2) % 3] - t[k]).normalized());
    points.emplace_back(t[k] + cut * (t[(k + 1) % 3] - t[k]).normalized());
  }
  return points;
}

// A net is no wider than its faces in a row. A wider one has a point far out, and its box would have endless tiles.
bool is_as_wide_as_its_faces(const CheckedDesign& d, const CheckedDesign::Piece& p) {
  double length = 0.0;
  for (const int f : p.faces) {
    const auto& face = d.faces[static_cast<std::size_t>(f)];
    double longest = 0.0;
    for (std::size_t s = 0; s < 3; ++s) {
      const P3 side =
          d.vertices[static_cast<std::size_t>(face[(s + 1) % 3])] - d.vertices[static_cast<std::size_t>(face[s])];
      longest = std::max(longest, side.norm());
    }
    length += longest;
  }
  Eigen::AlignedBox2d box;
  for (const FlatEdge& e : edges_of(p)) box.extend(e.a);
  constexpr double kStretch = 1.5;  // No limit allows an edge error anywhere near this.
  return !(box.diagonal().norm() > kStretch * length);
}

std::vector<FlatEdge> moved_edges_of(const CheckedDesign::Piece& p) {
  const double c = std::cos(p.theta), s = std::sin(p.theta);
  std::vector<FlatEdge> edges = edges_of(p);
  for (FlatEdge& e : edges) {
    for (P2* q : {&e.a, &e.b}) *q = P2(c * q->x() - s * q->y() + p.x, s * q->x() + c * q->y() + p.y);
  }
  return edges;
}

// Counts the tiles of the grid inside the moved outline one by one: no edge may enter a tile's interior, and its centre
// must lie inside.
int tiles_inside(const CheckedDesign::Piece& p, double cut) {
  const double h = kSide * std::sqrt(3.0) / 2;
  const std::vector<FlatEdge> edges = moved_edges_of(p);
  Eigen::AlignedBox2d box;
  for (const FlatEdge& e : edges) box.extend(e.a);
  int count = 0;
  for (int j = static_cast<int>(std::floor(box.min().y() / h)); j * h < box.max().y(); ++j) {
    const int first = static_cast<int>(std::floor(box.min().x() / kSide - 0.5 * j)) - 2;
    for (int i = first; kSide * (i + 0.5 * j) < box.max().x(); ++i) {
      for (const bool up : {true, false}) {
        const auto at = [&](int di, int dj) { return P2(kSide * (i + di + 0.5 * (j + dj)), h * (j + dj)); };
        const std::array<P2, 3> whole =
            up ? std::array{at(0, 0), at(1, 0), at(0, 1)} : std::array{at(1, 0), at(1, 1), at(0, 1)};
        const P2 middle = (whole[0] + whole[1] + whole[2]) / 3;
        std::vector<P2> t = without_corners(whole, cut);
        // Allows for the tolerance of the placement and for rounding.
        for (P2& q : t) q = middle + (q - middle) * (1 - 1e-5 / 8.66);
        const bool is_free =
            is_inside(middle, edges) && std::ranges::all_of(edges, [&](const FlatEdge& e) { return is_free_of(t, e); });
        count += is_free ? 1 : 0;
      }
    }
  }
  return count;
}

}  // namespace

void check_pieces(const CheckedDesign& design, Findings& findings) {
  for (const char* rule :
       {"piece-flip", "piece-scale", "piece-overlap", "piece-simple", "piece-faces", "piece-placement"})
    findings.rule(rule);
  std::set<int> used;
  for (std::size_t k = 0; k < design.pieces.size(); ++k) {
    const auto& p = design.pieces[k];
    for (const int face : p.faces) {
      if (!used.insert(face).second)
        findings.broken("piece-faces", piece_name(k), fmt::format("face {} stands in two pieces", face));
    }
    check_scale(design, k, findings);
    check_simple(p, k, findings);
    if (!is_as_wide_as_its_faces(design, p)) {
      findings.broken("piece-scale", piece_name(k), "its outline is wider than all of its faces in a row");
      continue;
    }
    const int tiles = p.modules > 0 ? tiles_inside(p, design.corner_cut) : 0;
    if (tiles < p.modules) {
      findings.broken("piece-placement", piece_name(k),
                      fmt::format("states {} modules, {} tiles lie inside", p.modules, tiles));
    }
    if (p.modules > p.upper_bound || (p.proved && p.modules != p.upper_bound)) {
      findings.broken("piece-placement", piece_name(k),
                      fmt::format("{} modules against the bound {}", p.modules, p.upper_bound));
    }
  }
}

}  // namespace triskin::check
