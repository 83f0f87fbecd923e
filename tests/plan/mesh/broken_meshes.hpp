// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::test {

using design::Mesh;
using design::Vec3;

using Dice = std::mt19937_64;
inline double dice(Dice& d, double low, double high) {
  return low + (high - low) * static_cast<double>(d() >> 11U) * 0x1p-53;
}
inline std::size_t pick(Dice& d, std::size_t n) {
  return static_cast<std::size_t>(d() % n);
}

/// Makes a grid of a parametric surface over u, v in 0 … 1, some 140 … 200 mm large. Closed surfaces are closed by
/// welding.
inline Mesh grid_of(const std::function<Vec3(double, double)>& place, int n, int m) {
  Mesh mesh;
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) mesh.vertices.push_back(place(static_cast<double>(i) / n, static_cast<double>(j) / m));
  }
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.faces.push_back({a, b, d});
      mesh.faces.push_back({a, d, c});
    }
  }
  return mesh;
}

/// Turns a profile around z; it gives radius and height over v.
inline std::function<Vec3(double, double)> turned(std::function<std::pair<double, double>(double)> profile) {
  return [profile = std::move(profile)](double u, double v) {
    const auto [r, z] = profile(v);
    return Vec3(r * std::cos(2.0 * M_PI * (u < 1.0 ? u : 0.0)), r * std::sin(2.0 * M_PI * (u < 1.0 ? u : 0.0)), z);
  };
}

struct BaseShape {
  const char* name;
  bool convex;  ///< True for a closed shape all of whose points see half the sky.
  std::function<Vec3(double, double)> place;
};

inline std::vector<BaseShape> base_shapes() {
  const auto ball = [](double a, double c) {
    return turned([a, c](double v) {
      return std::pair(v <= 0.0 || v >= 1.0 ? 0.0 : a * std::sin(M_PI * v), -c * std::cos(M_PI * v));
    });
  };
  return {{"ball", true, ball(75, 75)},
          {"egg", true, ball(60, 100)},
          {"can", true, turned([](double v) {
             return v < 0.25   ? std::pair(4.0 * v * 60.0, -70.0)
                    : v < 0.75 ? std::pair(60.0, -70.0 + 280.0 * (v - 0.25))
                               : std::pair(4.0 * (1.0 - v) * 60.0, 70.0);
           })},
          {"cone", true, turned([](double v) {
             return v < 0.3 ? std::pair(v / 0.3 * 80.0, 0.0)
                            : std::pair((1.0 - v) / 0.7 * 80.0, (v - 0.3) / 0.7 * 160.0);
           })},
          {"ring", false, turned([](double v) {
             const double t = 2.0 * M_PI * (v < 1.0 ? v : 0.0);
             return std::pair(70.0 + 35.0 * std::cos(t), 35.0 * std::sin(t));
           })},
          {"tube", false, turned([](double v) { return std::pair(55.0, 150.0 * v); })},
          {"bell", false, turned([](double v) { return std::pair(40.0 + 45.0 * v * v, -120.0 * v); })},
          {"dome", false, turned([](double v) {
             return std::pair(v <= 0.0 ? 0.0 : 85.0 * std::sin(1.4 * v), -85.0 * std::cos(1.4 * v));
           })},
          {"wave", false,
           [](double u, double v) { return Vec3(180 * u, 160 * v, 12 * std::sin(6 * u) * std::cos(5 * v)); }},
          {"saddle", false, [](double u, double v) {
             return Vec3(170 * u, 170 * v, 90 * (u - 0.5) * (u - 0.5) - 90 * (v - 0.5) * (v - 0.5));
           }}};
}

inline void append(Mesh& mesh, const Mesh& other) {
  const int shift = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
}

inline Vec3& corner(Mesh& m, std::size_t face, std::size_t k) {
  return m.vertices[static_cast<std::size_t>(m.faces[face][k % 3])];
}

inline Vec3 middle_of(const Mesh& m) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : m.vertices) sum += v;
  return sum / static_cast<double>(m.vertices.size());
}

inline Mesh apart(const Mesh& m) {
  Mesh result;
  for (const auto& f : m.faces) {
    const int first = static_cast<int>(result.vertices.size());
    for (const int v : f) result.vertices.push_back(m.vertices[static_cast<std::size_t>(v)]);
    result.faces.push_back({first, first + 1, first + 2});
  }
  return result;
}

struct Damage {
  const char* name;
  bool keeps_outside;  ///< True if the clean shape is still what is seen from outside.
  std::function<void(Mesh&, Dice&)> make;
};

namespace damage {

// Pushes vertices through the other side.
inline void pushed(Mesh& m, Dice& d) {
  const Vec3 middle = middle_of(m);
  for (int k = 0; k < 3; ++k) {
    Vec3& v = m.vertices[pick(d, m.vertices.size())];
    v += dice(d, 1.2, 2.2) * (middle - v);
  }
}
inline void fins(Mesh& m, Dice& d) {
  for (int k = 0; k < 12; ++k) {
    const std::size_t f = pick(d, m.faces.size());
    const Vec3 a = corner(m, f, 0), b = corner(m, f, 1), c = corner(m, f, 2);
    const Vec3 up = (b - a).cross(c - a);
    if (!(up.norm() > 0.0)) continue;
    const int tip = static_cast<int>(m.vertices.size());
    m.vertices.push_back(0.5 * (a + b) + dice(d, 2.0, 12.0) * up.normalized());
    m.faces.push_back({m.faces[f][0], m.faces[f][1], tip});
  }
}
inline void inside_out(Mesh& m, Dice& /*unused*/) {
  for (auto& f : m.faces) std::swap(f[1], f[2]);
}
inline void doubled(Mesh& m, Dice& d) {
  Mesh inner = m;
  const Vec3 middle = middle_of(m);
  const double scale = dice(d, 0.9, 0.99);
  for (Vec3& v : inner.vertices) v = middle + scale * (v - middle);
  if (pick(d, 2) == 0) inside_out(inner, d);
  append(m, inner);
}
inline void soup(Mesh& m, Dice& d) {
  m = apart(m);
  for (auto& f : m.faces) {
    if (pick(d, 2) == 0) std::swap(f[1], f[2]);
  }
  for (std::size_t k = m.faces.size(); k > 1; --k) std::swap(m.faces[k - 1], m.faces[pick(d, k)]);
}
// Adds a sheet without thickness through the middle, with different diagonals on its two sides.
inline void sheet(Mesh& m, Dice& d) {
  const Vec3 middle = middle_of(m);
  const double s = dice(d, 30.0, 50.0);
  const int first = static_cast<int>(m.vertices.size());
  for (const auto& [x, z] : {std::pair{-s, -s}, std::pair{s, -s}, std::pair{s, s}, std::pair{-s, s}})
    m.vertices.push_back(middle + Vec3(x, 0.3 * x, z));
  m.faces.push_back({first, first + 1, first + 2});
  m.faces.push_back({first, first + 2, first + 3});
  m.faces.push_back({first + 1, first, first + 3});
  m.faces.push_back({first + 1, first + 3, first + 2});
}
inline void gaps(Mesh& m, Dice& d) {
  m = apart(m);
  for (Vec3& v : m.vertices) v += Vec3(dice(d, -0.04, 0.04), dice(d, -0.04, 0.04), dice(d, -0.04, 0.04));
}
inline void split(Mesh& m, std::size_t f, const Vec3& at) {
  const auto c = m.faces[f];
  const int v = static_cast<int>(m.vertices.size());
  m.vertices.push_back(at);
  m.faces[f] = {c[0], c[1], v};
  m.faces.push_back({c[1], c[2], v});
  m.faces.push_back({c[2], c[0], v});
}
inline void slivers(Mesh& m, Dice& d) {
  for (int k = 0; k < 40; ++k) {
    const std::size_t f = pick(d, m.faces.size());
    const double t = dice(d, 0.2, 0.8), e = std::pow(10.0, dice(d, -7.0, -3.0));
    split(m, f, (1.0 - e) * ((1.0 - t) * corner(m, f, 0) + t * corner(m, f, 1)) + e * corner(m, f, 2));
  }
}
inline void needles(Mesh& m, Dice& d) {
  for (int k = 0; k < 40; ++k) {
    const std::size_t f = pick(d, m.faces.size());
    const double e = std::pow(10.0, dice(d, -9.0, -4.0));
    split(m, f, (1.0 - e) * corner(m, f, 0) + 0.5 * e * (corner(m, f, 1) + corner(m, f, 2)));
  }
}
inline void t_junctions(Mesh& m, Dice& d) {
  for (int k = 0; k < 30; ++k) {
    const std::size_t f = pick(d, m.faces.size());
    const auto c = m.faces[f];
    const int v = static_cast<int>(m.vertices.size());
    const double t = dice(d, 0.1, 0.9);
    m.vertices.push_back((1.0 - t) * corner(m, f, 0) + t * corner(m, f, 1));
    m.faces[f] = {c[0], v, c[2]};
    m.faces.push_back({v, c[1], c[2]});
  }
}
inline void flipped(Mesh& m, Dice& d) {
  for (auto& f : m.faces) {
    if (pick(d, 4) == 0) std::swap(f[1], f[2]);
  }
}
inline void copies(Mesh& m, Dice& d) {
  for (int k = 0; k < 30; ++k) {
    const auto f = m.faces[pick(d, m.faces.size())];
    m.faces.push_back({f[1], f[0], f[2]});
    m.faces.push_back({f[0], f[0], f[1]});
  }
}
inline void holes(Mesh& m, Dice& d) {
  for (int k = 0; k < 20; ++k) {
    m.faces[pick(d, m.faces.size())] = m.faces.back();
    m.faces.pop_back();
  }
}
inline void crossed(Mesh& m, Dice& d) {
  Mesh other = m;
  const Vec3 by(dice(d, 20.0, 60.0), dice(d, -30.0, 30.0), dice(d, 5.0, 40.0));
  for (Vec3& v : other.vertices) v += by;
  append(m, other);
}
inline void noise(Mesh& m, Dice& d) {
  for (Vec3& v : m.vertices) v += Vec3(dice(d, -3.0, 3.0), dice(d, -3.0, 3.0), dice(d, -3.0, 3.0));
}

// Makes vertices that two fans share: corners of tetrahedra that stand on them, and vertices pulled onto others.
inline void pinched(Mesh& m, Dice& d) {
  for (int k = 0; k < 6; ++k) {
    const int at = static_cast<int>(pick(d, m.vertices.size()));
    const Vec3 p = m.vertices[static_cast<std::size_t>(at)];
    const Vec3 out = (p - middle_of(m)).normalized() * dice(d, 3.0, 15.0);
    const int first = static_cast<int>(m.vertices.size());
    m.vertices.push_back(p + out);
    m.vertices.push_back(p + out + Vec3(dice(d, 1.0, 4.0), 0, 0));
    m.vertices.push_back(p + out + Vec3(0, dice(d, 1.0, 4.0), dice(d, -2.0, 2.0)));
    for (const auto& f : {std::array{at, first + 1, first}, std::array{at, first + 2, first + 1},
                          std::array{at, first, first + 2}, std::array{first, first + 1, first + 2}})
      m.faces.push_back(f);
  }
  for (int k = 0; k < 4; ++k) m.vertices[pick(d, m.vertices.size())] = m.vertices[pick(d, m.vertices.size())];
}
// Adds tetrahedra and single faces of a few mm without connection, far enough outside to hide nothing; some lie inside.
inline void crumbs(Mesh& m, Dice& d) {
  const Vec3 middle = middle_of(m);
  for (int k = 0; k < 25; ++k) {
    const Vec3 at = m.vertices[pick(d, m.vertices.size())];
    const Vec3 p = at + (at - middle).normalized() * (k % 5 == 0 ? -10.0 : dice(d, 15.0, 60.0));
    const int first = static_cast<int>(m.vertices.size());
    for (int c = 0; c < 4; ++c)
      m.vertices.push_back(p + Vec3(dice(d, -2.0, 2.0), dice(d, -2.0, 2.0), dice(d, -2.0, 2.0)));
    m.faces.push_back({first, first + 1, first + 2});
    if (k % 2 == 0) continue;
    for (const auto& f : {std::array{first, first + 3, first + 1}, std::array{first + 1, first + 3, first + 2},
                          std::array{first, first + 2, first + 3}})
      m.faces.push_back(f);
  }
}
// Moves the mesh up to a kilometre off the origin, and adds a vertex without a face 10 km off.
inline void far_off(Mesh& m, Dice& d) {
  const Vec3 by(dice(d, -1e6, 1e6), dice(d, -1e6, 1e6), std::pow(10.0, dice(d, 3.0, 6.0)));
  for (Vec3& v : m.vertices) v += by;
  m.vertices.emplace_back(1e7, -1e7, 1e7);
}

}  // namespace damage

inline std::vector<Damage> damages() {
  using namespace damage;
  return {{"pushed", false, pushed},
          {"fins", true, fins},
          {"inside_out", true, inside_out},
          {"doubled", true, doubled},
          {"soup", true, soup},
          {"sheet", true, sheet},
          {"gaps", false, gaps},
          {"slivers", true, slivers},
          {"needles", true, needles},
          {"t_junctions", true, t_junctions},
          {"flipped", true, flipped},
          {"copies", true, copies},
          {"holes", false, holes},
          {"crossed", false, crossed},
          {"noise", false, noise},
          {"pinched", false, pinched},
          {"crumbs", true, crumbs},
          {"far_off", false, far_off}};
}

}  // namespace triskin::test
