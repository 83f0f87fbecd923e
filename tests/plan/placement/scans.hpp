// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/evaluator.hpp"
#include "polygons.hpp"

namespace triskin::test {

/// Returns the most modules found without any bound: each edge on a grid line in ten places, shifts of 2 mm at the
/// angle of each edge and at 60 others, and 40 random placements that climb by steps of 4 … 0.06 mm.
inline int most_by_scan(const Polygon& outline, double corner_cut_mm, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const placement::PreparedPolygon polygon = placement::prepare(outline);
  const placement::TileGrid grid = placement::tile_grid(placement::TileShape::kTriangle, 0.0, corner_cut_mm);
  placement::Evaluator evaluator(polygon, grid);
  int most = 0;
  const auto count = [&](const placement::Motion& m) {
    const int modules = evaluator.count(m, -1e-6);
    most = std::max(most, modules);
    return modules;
  };
  const auto shift = [&](double theta) {
    for (double y = 0; y < grid.row_height_mm; y += 2.0)
      for (double x = 0; x < grid.row_step_mm; x += 2.0) count({x, y, theta});
  };
  for (const auto& [a, b] : polygon.edges) {
    const double theta = -std::atan2(b.y() - a.y(), b.x() - a.x()), c = std::cos(theta), s = std::sin(theta);
    for (int k = 0; k < 10; ++k)
      count({0.1 * k * grid.row_step_mm - (c * a.x() - s * a.y()), -(s * a.x() + c * a.y()), theta});
    shift(theta);
  }
  for (int k = 0; k < 60; ++k) shift(grid.period_rad * k / 60);
  for (int k = 0; k < 40; ++k) {
    placement::Motion at{uniform(random, 0, grid.row_step_mm), uniform(random, 0, grid.row_height_mm),
                         uniform(random, 0, grid.period_rad)};
    int value = count(at);
    for (double step = 4.0; step > 0.05; step *= 0.5) {
      for (const auto& [dx, dy, dt] :
           {std::array{1., 0., 0.}, {-1., 0., 0.}, {0., 1., 0.}, {0., -1., 0.}, {0., 0., 1.}, {0., 0., -1.}}) {
        const placement::Motion next{at.x + step * dx, at.y + step * dy,
                                     at.theta + step * dt / std::max(1.0, polygon.radius_mm)};
        const int modules = count(next);
        if (modules <= value) continue;
        value = modules;
        at = next;
      }
    }
  }
  return most;
}

}  // namespace triskin::test
