// SPDX-License-Identifier: GPL-3.0-or-later
// Makes simple meshes for the tests of extract.
#pragma once
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::test {

using design::Mesh;
using design::Vec3;

// Joins corners at the same place, as reading a file does.
inline Mesh welded(const Mesh& m) {
  Mesh result;
  std::map<std::array<long, 3>, int> seen;
  std::vector<int> index;
  for (const Vec3& v : m.vertices) {
    const auto [at, is_new] =
        seen.try_emplace({std::lround(1e3 * v.x()), std::lround(1e3 * v.y()), std::lround(1e3 * v.z())},
                         static_cast<int>(result.vertices.size()));
    if (is_new) result.vertices.push_back(v);
    index.push_back(at->second);
  }
  for (const auto& f : m.faces)
    result.faces.push_back({index[static_cast<std::size_t>(f[0])], index[static_cast<std::size_t>(f[1])],
                            index[static_cast<std::size_t>(f[2])]});
  return result;
}

// Makes a cube of 12 · n² faces that face outward.
inline Mesh cube(const Vec3& middle, double side, int n = 4) {
  Mesh m;
  const std::array<Vec3, 3> axes{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (std::size_t k = 0; k < 3; ++k) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 out = sign * axes[k], u = axes[(k + 1) % 3], v = out.cross(u);
      const int base = static_cast<int>(m.vertices.size());
      for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i)
          m.vertices.push_back(middle + side * (0.5 * out + (static_cast<double>(i) / n - 0.5) * u +
                                                (static_cast<double>(j) / n - 0.5) * v));
      }
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          const int a = base + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
          m.faces.push_back({a, b, d});
          m.faces.push_back({a, d, c});
        }
      }
    }
  }
  return welded(m);
}

inline Mesh both(Mesh a, const Mesh& b) {
  const int shift = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& f : b.faces) a.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return a;
}

inline Mesh inside_out(Mesh m) {
  for (auto& f : m.faces) std::swap(f[1], f[2]);
  return m;
}

inline Mesh square(double side, int n) {
  Mesh m;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) m.vertices.emplace_back(side * i / n, side * j / n, 0.0);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      m.faces.push_back({a, b, d});
      m.faces.push_back({a, d, c});
    }
  }
  return m;
}

}  // namespace triskin::test
