// SPDX-License-Identifier: GPL-3.0-or-later
// Why the bound holds. A module of side 30 mm, drawn in by the tolerance, lies in the outline P, and no two overlap. It
// contains its incircle (radius r), so its centre lies in E = {c : the disc (c, r) lies in P}, and it lies in the disc
// (c, R) around its centre. So all modules lie in U = {p in P : some c in E with |p − c| at most R}, and each, being
// connected, in one component of U: with areas a1, a2, … of components (or of sets that contain them) and A that of a
// module there are at most floor(a1/A) + floor(a2/A) + … of them. The cells below are an outer approximation: a cell
// counts unless it is certain that no point of it belongs to E or U. With a gap g modules widened by g/2 do not overlap
// either, and lie in P widened by g/2: its area over that of such a module is a second bound.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "triskin/geometry/segment.hpp"
#include "triskin/placement/lattices.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

constexpr double kInradius_mm = kHeight_mm / 3.0, kCircumradius_mm = 2.0 * kInradius_mm;
constexpr int kCellsAcross = 160;  // Along the longer side of the outline.

using Ring = std::vector<Vec2>;

double distance_to_border(const Polygon& polygon, const Vec2& p, bool& is_inside) {
  double least = std::numeric_limits<double>::infinity();
  is_inside = false;
  const auto walk = [&](const Ring& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      least = std::min(least, geometry::distance_to_segment(p, a, b));
      if (geometry::ray_crosses(p, a, b)) is_inside = !is_inside;
    }
  };
  walk(polygon.outer);
  for (const Ring& hole : polygon.holes) walk(hole);
  return least;
}

// Returns the part of a ring in a box (Sutherland, Hodgman 1974): its area is that of the part, whatever edges of zero
// width it has.
double area_in_box(Ring ring, const Vec2& low, const Vec2& high) {
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1.0 : -1.0, limit = sign * (side % 2 == 0 ? low[axis] : high[axis]);
    Ring kept;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      const double at_a = sign * a[axis] - limit, at_b = sign * b[axis] - limit;
      if (at_a >= 0.0) kept.push_back(a);
      if ((at_a < 0.0) != (at_b < 0.0)) kept.emplace_back(a + at_a / (at_a - at_b) * (b - a));
    }
    ring = std::move(kept);
  }
  return ring_area(ring);
}

struct Cells {
  Vec2 origin;
  double size_mm;
  int columns, rows;
  [[nodiscard]] Vec2 low(int c, int r) const { return origin + size_mm * Vec2(c, r); }
  [[nodiscard]] std::size_t index(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c);
  }
};

Cells cells_over(const Polygon& polygon) {
  Vec2 low = polygon.outer[0], high = low;
  for (const Vec2& p : polygon.outer) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double size = std::max((high - low).maxCoeff() / kCellsAcross, 1e-3);
  const auto count = [&](double length) { return std::max(1, static_cast<int>(std::ceil(length / size))); };
  return {low, size, count(high.x() - low.x()), count(high.y() - low.y())};
}

double length_of(const Ring& ring) {
  double sum = 0.0;
  for (std::size_t k = 0; k < ring.size(); ++k) sum += (ring[(k + 1) % ring.size()] - ring[k]).norm();
  return sum;
}

// Returns the area of P in each cell of U, 0 elsewhere.
std::vector<double> usable_areas(const Polygon& polygon, const Cells& cells, double inradius_mm) {
  const double half_mm = cells.size_mm * std::numbers::sqrt2 / 2.0;
  std::vector<double> area(cells.index(0, cells.rows), 0.0);
  std::vector<std::array<int, 2>> centres;  // Cells that may hold a point of E.
  for (int r = 0; r < cells.rows; ++r) {
    for (int c = 0; c < cells.columns; ++c) {
      bool is_inside = false;
      const double border_mm =
          distance_to_border(polygon, cells.low(c, r) + Vec2::Constant(cells.size_mm / 2.0), is_inside);
      if (is_inside ? border_mm + half_mm >= inradius_mm : half_mm >= border_mm + inradius_mm)
        centres.push_back({c, r});
    }
  }
  // Points of two cells are nearer than the circumradius if their middles are nearer than that and both half diagonals.
  const double reach = (kCircumradius_mm + 2.0 * half_mm) / cells.size_mm;
  const int rows = static_cast<int>(reach);
  for (const auto& [c, r] : centres) {
    for (int y = std::max(0, r - rows); y <= std::min(cells.rows - 1, r + rows); ++y) {
      const int columns = static_cast<int>(std::sqrt(reach * reach - (y - r) * (y - r)));
      for (int x = std::max(0, c - columns); x <= std::min(cells.columns - 1, c + columns); ++x)
        area[cells.index(x, y)] = 1.0;
    }
  }
  for (int r = 0; r < cells.rows; ++r) {
    for (int c = 0; c < cells.columns; ++c) {
      double& a = area[cells.index(c, r)];
      if (a == 0.0) continue;
      const Vec2 low = cells.low(c, r), high = low + Vec2::Constant(cells.size_mm);
      a = area_in_box(polygon.outer, low, high);
      for (const Ring& hole : polygon.holes) a += area_in_box(hole, low, high);  // Holes run clockwise.
    }
  }
  return area;
}

// Returns the areas of the components; cells that meet at a side or corner hang together.
std::vector<double> component_areas(std::vector<double> area, const Cells& cells) {
  const double empty_mm2 = 1e-9 * cells.size_mm * cells.size_mm;  // What rounding leaves of a cell outside.
  std::vector<double> components;
  std::vector<std::array<int, 2>> open;
  for (int r = 0; r < cells.rows; ++r) {
    for (int c = 0; c < cells.columns; ++c) {
      if (area[cells.index(c, r)] <= empty_mm2) continue;
      components.push_back(0.0);
      open.push_back({c, r});
      while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        if (x < 0 || y < 0 || x >= cells.columns || y >= cells.rows || area[cells.index(x, y)] <= empty_mm2) continue;
        components.back() += std::exchange(area[cells.index(x, y)], 0.0);
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) open.push_back({x + dx, y + dy});
        }
      }
    }
  }
  return components;
}

}  // namespace

int modules_bound(const Polygon& polygon, double gap_mm, double tolerance_mm) {
  constexpr double kRounding = 1.0 + 1e-9;
  const double inradius_mm = kInradius_mm - tolerance_mm, drawn_in = inradius_mm / kInradius_mm;
  const double module_mm2 = kModuleArea_mm2 * drawn_in * drawn_in;
  const Cells cells = cells_over(polygon);
  int by_parts = 0;
  for (const double mm2 : component_areas(usable_areas(polygon, cells, inradius_mm), cells))
    by_parts += static_cast<int>(std::floor(mm2 / module_mm2 * kRounding));
  if (gap_mm <= 0.0) return by_parts;
  const double half_gap_mm = gap_mm / 2.0, disc_mm2 = std::numbers::pi * half_gap_mm * half_gap_mm;
  double border_mm = length_of(polygon.outer);
  for (const Ring& hole : polygon.holes) border_mm += length_of(hole);
  const double widened_mm2 = polygon_area(polygon) + border_mm * half_gap_mm + disc_mm2;
  const double with_strip_mm2 = module_mm2 + 3.0 * kSide_mm * drawn_in * half_gap_mm + disc_mm2;
  return std::min(by_parts, static_cast<int>(std::floor(widened_mm2 / with_strip_mm2 * kRounding)));
}

}  // namespace triskin::placement
