// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "triskin/base/index.hpp"
#include "triskin/design/module.hpp"
#include "triskin/lattice/grow_lattice.hpp"

namespace triskin::lattice {

// Maps a grid of nu × nv cells over the unit square to space.
inline Mesh grid_mesh(int nu, int nv, const std::function<Vec3(double, double)>& place) {
  Mesh m;
  for (int v = 0; v <= nv; ++v) {
    for (int u = 0; u <= nu; ++u) m.vertices.push_back(place(static_cast<double>(u) / nu, static_cast<double>(v) / nv));
  }
  const auto id = [nu](int u, int v) { return v * (nu + 1) + u; };
  for (int v = 0; v < nv; ++v) {
    for (int u = 0; u < nu; ++u) {
      m.faces.push_back({id(u, v), id(u + 1, v), id(u + 1, v + 1)});
      m.faces.push_back({id(u, v), id(u + 1, v + 1), id(u, v + 1)});
    }
  }
  return m;
}

inline Mesh plane(double width, double height) {
  return grid_mesh(8, 8, [=](double u, double v) { return Vec3(width * u, height * v, 0.0); });
}

inline Mesh half_cylinder(double radius, double length) {
  return grid_mesh(48, 6, [=](double u, double v) {
    return Vec3(radius * std::cos(M_PI * u), length * v, radius * std::sin(M_PI * u));
  });
}

inline Mesh sphere_cap(double radius, double opening) {
  // Polar rings without a pole vertex would leave a hole; a square patch by gnomonic projection has none.
  const double t = std::tan(opening / 2.0);
  return grid_mesh(24, 24, [=](double u, double v) {
    return Vec3(radius * Vec3(t * (2 * u - 1), t * (2 * v - 1), 1.0).normalized());
  });
}

// Divides every face into four at the middles of its sides, this many times; the shape stays the same.
inline Mesh divided(const Mesh& m, int times = 1) {
  if (times == 0) return m;
  Mesh out{m.vertices, {}};
  std::map<std::pair<int, int>, int> middle;
  const auto between = [&](int a, int b) {
    const auto [it, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<int>(out.vertices.size()));
    if (is_new) out.vertices.push_back(0.5 * (m.vertices[at(a)] + m.vertices[at(b)]));
    return it->second;
  };
  for (const auto& [a, b, c] : m.faces) {
    const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
    out.faces.insert(out.faces.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return divided(out, times - 1);
}

inline Mesh turned_outward(Mesh m, const Vec3& inside) {
  const auto& f = m.faces.front();
  const Vec3 a = m.vertices[at(f[0])], n = (m.vertices[at(f[1])] - a).cross(m.vertices[at(f[2])] - a);
  if (n.dot(a - inside) < 0) {
    for (auto& g : m.faces) std::swap(g[1], g[2]);
  }
  return m;
}

inline SurfaceLatticeOptions effort(int iterations) {
  SurfaceLatticeOptions o;
  o.iterations = iterations;
  o.time_limit_s = 300.0;
  return o;
}

inline Vec3 normal_of(const PlacedModule& m) {
  return (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
}
inline Vec3 center_of(const PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

}  // namespace triskin::lattice
