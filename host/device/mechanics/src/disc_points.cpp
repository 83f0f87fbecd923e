// SPDX-License-Identifier: GPL-3.0-or-later
#include "disc_points.hpp"

#include <cmath>
#include <numbers>

#include "quadrature.hpp"

namespace triskin::mechanics {
namespace {

std::vector<DiscPoint> made_points(int rings, int around) {
  const Quadrature squares = gauss_legendre(rings, 0.0, 1.0);
  std::vector<DiscPoint> points;
  for (int ring = 0; ring < rings; ++ring) {
    const double radius = std::sqrt(squares.nodes[ring]);
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5 * (ring % 2)) / around;
      points.push_back({{radius * std::cos(angle), radius * std::sin(angle)}, squares.weights[ring] / around});
    }
  }
  return points;
}

}  // namespace

const std::vector<DiscPoint>& disc_points() {
  static const std::vector<DiscPoint> points = made_points(6, 16);
  return points;
}

const std::vector<DiscPoint>& coarse_disc_points() {
  static const std::vector<DiscPoint> points = made_points(3, 8);
  return points;
}

}  // namespace triskin::mechanics
