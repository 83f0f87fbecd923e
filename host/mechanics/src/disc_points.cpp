// SPDX-License-Identifier: GPL-3.0-or-later
#include "disc_points.hpp"

#include <cmath>
#include <numbers>

#include "quadrature.hpp"

namespace triskin::mechanics {
namespace {

std::vector<DiscPoint> made_points() {
  constexpr int kRings = 6, kAround = 16;
  const Quadrature squares = gauss_legendre(kRings, 0.0, 1.0);
  std::vector<DiscPoint> points;
  for (int ring = 0; ring < kRings; ++ring) {
    const double radius = std::sqrt(squares.nodes[ring]);
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5 * (ring % 2)) / kAround;
      points.push_back({{radius * std::cos(angle), radius * std::sin(angle)}, squares.weights[ring] / kAround});
    }
  }
  return points;
}

}  // namespace

const std::vector<DiscPoint>& disc_points() {
  static const std::vector<DiscPoint> points = made_points();
  return points;
}

}  // namespace triskin::mechanics
