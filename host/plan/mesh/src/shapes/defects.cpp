// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "triskin/base/dice.hpp"

namespace triskin::mesh {
namespace {

using Face = std::array<int, 3>;
constexpr std::uint64_t kSeed = 11;

const Vec3& vertex(const Mesh& m, int v) {
  return m.vertices[static_cast<std::size_t>(v)];
}

int add(Mesh& m, const Vec3& p) {
  m.vertices.push_back(p);
  return static_cast<int>(m.vertices.size()) - 1;
}

std::vector<Vec3> normals_of(const Mesh& m) {
  std::vector<Vec3> normal(m.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : m.faces) {
    const Vec3 n = (vertex(m, b) - vertex(m, a)).cross(vertex(m, c) - vertex(m, a));
    for (const int v : {a, b, c}) normal[static_cast<std::size_t>(v)] += n;
  }
  for (Vec3& n : normal) n.normalize();
  return normal;
}

// Adds walls, ribs and loose parts of the shell; `normal` holds one vector for each vertex of the cover.
class Shell {
 public:
  explicit Shell(const Mesh& cover) : cover_(cover), normal_(normals_of(cover)), mesh_(cover) {}

  Mesh build() {
    inner_wall();
    for (std::size_t f = 40; f < cover_.faces.size(); f += 90) rib(cover_.faces[f]);
    for (std::size_t v = 25; v < cover_.vertices.size(); v += 70) boss(static_cast<int>(v));
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] Vec3 below(int v, double depth_mm) const {
    return vertex(cover_, v) - depth_mm * normal_[static_cast<std::size_t>(v)];
  }

  void inner_wall() {
    const int base = static_cast<int>(mesh_.vertices.size());
    for (std::size_t v = 0; v < cover_.vertices.size(); ++v) add(mesh_, below(static_cast<int>(v), 3.0));
    for (const auto& [a, b, c] : cover_.faces) mesh_.faces.push_back({base + a, base + c, base + b});
  }

  // Adds two faces that stand on a side of a face of the outer wall and end inside the inner one.
  void rib(const Face& face) {
    const int a = face[0], b = face[1], c = add(mesh_, below(a, 9.0)), d = add(mesh_, below(b, 9.0));
    mesh_.faces.insert(mesh_.faces.end(), {{a, b, d}, {a, d, c}});
  }

  // Adds an open tube of 8 sides, 3 mm radius, 5 … 13 mm inside the wall.
  void boss(int v) {
    const Vec3& n = normal_[static_cast<std::size_t>(v)];
    const Vec3 x = n.unitOrthogonal(), y = n.cross(x);
    const int base = static_cast<int>(mesh_.vertices.size());
    for (int k = 0; k < 16; ++k) {
      const int side = k / 2;
      const double turn = M_PI * side / 4.0;
      add(mesh_, below(v, k % 2 == 0 ? 5.0 : 13.0) + 3.0 * (std::cos(turn) * x + std::sin(turn) * y));
    }
    for (int k = 0; k < 16; k += 2) {
      const int a = base + k, b = a + 1, c = base + (k + 2) % 16, d = c + 1;
      mesh_.faces.insert(mesh_.faces.end(), {{a, c, b}, {c, d, b}});
    }
  }

  const Mesh& cover_;
  std::vector<Vec3> normal_;
  Mesh mesh_;
};

// Divides one side of the face; its neighbour there keeps the whole side.
void make_t_junction(Mesh& m, std::size_t f) {
  const auto [a, b, c] = m.faces[f];
  const int middle = add(m, 0.5 * (vertex(m, a) + vertex(m, b)));
  m.faces[f] = {a, middle, c};
  m.faces.push_back({middle, b, c});
}

void add_degenerate_face(Mesh& m, const Face& face) {
  const auto [a, b, c] = face;
  const int middle = add(m, 0.5 * (vertex(m, b) + vertex(m, c)));
  m.faces.push_back({b, middle, c});
  m.faces.push_back({a, b, b});
}

void own_vertices(Mesh& m, Face& face) {
  for (int& v : face) v = add(m, Vec3(vertex(m, v)));
}

// Draws a log-uniform number between the two.
double between(Dice& dice, double low, double high) {
  return low * std::pow(high / low, dice.unit());
}

using Sides = std::map<std::pair<int, int>, std::size_t>;  // Maps a directed side to its face.

Sides sides_of(const Mesh& m) {
  Sides sides;
  for (std::size_t f = 0; f < m.faces.size(); ++f) {
    for (std::size_t s = 0; s < 3; ++s) sides[{m.faces[f][s], m.faces[f][(s + 1) % 3]}] = f;
  }
  return sides;
}

// Divides the side a->b of a face and of its neighbour close to a, so that both lose a needle. The neighbour must be
// unchanged so far.
void make_needles(Mesh& m, std::size_t f, const Sides& sides, std::vector<bool>& touched, double width_mm) {
  const auto [a, b, c] = m.faces[f];
  const auto other = sides.find({b, a});
  if (other == sides.end() || touched[other->second]) return;
  const Face across = m.faces[other->second];
  const int d = across[0] != a && across[0] != b ? across[0] : across[1] != a && across[1] != b ? across[1] : across[2];
  const int close = add(m, vertex(m, a) + width_mm * (vertex(m, b) - vertex(m, a)).normalized());
  m.faces[f] = {a, close, c};
  m.faces[other->second] = {close, a, d};
  m.faces.insert(m.faces.end(), {{close, b, c}, {b, close, d}});
  touched[f] = touched[other->second] = true;
}

// Adds a vertex inside the face, `height_mm` from the middle of its first side, so that the new face there is a sliver.
void make_sliver(Mesh& m, std::size_t f, double height_mm) {
  const auto [a, b, c] = m.faces[f];
  const Vec3 middle = 0.5 * (vertex(m, a) + vertex(m, b)), way = vertex(m, c) - middle;
  const int inside = add(m, middle + std::min(0.3, height_mm / way.norm()) * way);
  m.faces[f] = {a, b, inside};
  m.faces.insert(m.faces.end(), {{b, c, inside}, {c, a, inside}});
}

}  // namespace

Mesh as_dirty_shell(const Mesh& cover) {
  Mesh m = Shell(cover).build();
  Dice dice(kSeed);
  for (std::size_t f = 0, n = m.faces.size(); f < n; ++f) {
    const int kind = dice.below(100);
    if (kind < 1) make_t_junction(m, f);
    if (kind >= 1 && kind < 4) m.faces.push_back(m.faces[f]);
    if (kind >= 4 && kind < 6) add_degenerate_face(m, m.faces[f]);
    if (kind >= 6 && kind < 14) std::swap(m.faces[f][1], m.faces[f][2]);
    if (kind >= 14 && kind < 34) own_vertices(m, m.faces[f]);
  }
  return m;
}

Mesh with_near_degenerate_faces(const Mesh& cover) {
  constexpr double kMin_mm = 2e-4, kMax_mm = 1e-2, kBelowWeld_mm = 2e-6;
  Mesh m = cover;
  Dice dice(kSeed);
  const Sides sides = sides_of(cover);
  std::vector<bool> touched(cover.faces.size(), false);
  for (std::size_t f = 0; f < cover.faces.size(); ++f) {
    const int kind = dice.below(100);
    const double small_mm = between(dice, kMin_mm, kMax_mm);
    if (touched[f]) continue;
    if (kind < 12) make_needles(m, f, sides, touched, small_mm);
    if (kind >= 12 && kind < 16) make_needles(m, f, sides, touched, kBelowWeld_mm);
    if (kind >= 16 && kind < 30) make_sliver(m, f, small_mm), touched[f] = true;
  }
  return m;
}

}  // namespace triskin::mesh
