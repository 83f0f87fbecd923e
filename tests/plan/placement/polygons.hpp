// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <random>

#include "triskin/design/mesh.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::test {

using design::Polygon;
using design::Vec2;

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Makes a star-shaped outline of about `area_cm2` with `n` vertices.
inline std::vector<Vec2> star(std::mt19937_64& random, int n, double area_cm2, double roughness = 0.25) {
  const double radius = std::sqrt(area_cm2 * 100.0 / M_PI);
  std::vector<Vec2> ring;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n, r = radius * uniform(random, 1 - roughness, 1 + roughness);
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return ring;
}

inline Polygon random_polygon(std::mt19937_64& random, int n, double area_cm2, int holes) {
  Polygon p;
  p.outer = star(random, n, area_cm2);
  const double reach = 0.4 * std::sqrt(area_cm2 * 100.0 / M_PI);
  for (int h = 0; h < holes; ++h) {
    auto ring = star(random, 7, uniform(random, 0.05, 3.0), 0.1);
    const double angle = 2 * M_PI * h / holes;
    for (Vec2& v : ring) v += reach * Vec2(std::cos(angle), std::sin(angle));
    p.holes.push_back(ring);
  }
  return placement::normalize_polygon(p, "random");
}

inline Polygon moved(const Polygon& p, double angle, const Vec2& by, bool mirror = false) {
  Polygon q = p;
  const auto move = [&](Vec2& v) {
    if (mirror) v.x() = -v.x();
    v = Vec2(std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y()) + by;
  };
  for (Vec2& v : q.outer) move(v);
  for (auto& hole : q.holes) {
    for (Vec2& v : hole) move(v);
  }
  return placement::normalize_polygon(q, "moved");
}

}  // namespace triskin::test
