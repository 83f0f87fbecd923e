// SPDX-License-Identifier: GPL-3.0-or-later
#include "sheet.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "triskin/base/dice.hpp"

namespace triskin::mesh {
namespace {

constexpr double kJitter = 0.28;  // Vertices move by at most this fraction of a grid cell.
constexpr double kSnap = 0.3;     // A vertex this near to the cut moves onto it, so that no sliver is cut off.
constexpr std::uint64_t kSeed = 7;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// One grid of the sheet: vertices in (u, v), faces, and the value of `keep`, which is 0 for vertices on the cut.
class Grid {
 public:
  Grid(const Sheet& sheet, int nu, int nv) : sheet_(sheet), nu_(nu), nv_(nv) {
    make_vertices();
    for (int j = 0; j < nv_; ++j) {
      for (int i = 0; i < nu_; ++i) add_cell(i, j);
    }
    if (sheet_.keep) snap();
  }

  Mesh mesh() {
    Mesh out;
    for (const Vec2& p : uv_) out.vertices.push_back(place(p));
    for (const auto& f : faces_) clip(f, out);
    return without_unused_vertices(out);
  }

 private:
  [[nodiscard]] Vec3 place(const Vec2& p) const { return sheet_.place(p.x(), p.y()); }
  [[nodiscard]] int columns() const { return sheet_.closed ? nu_ : nu_ + 1; }
  [[nodiscard]] int id(int i, int j) const { return j * columns() + i % columns(); }
  [[nodiscard]] double keep(const Vec2& p) const { return sheet_.keep ? sheet_.keep(place(p)) : 1.0; }

  void make_vertices() {
    Dice dice(kSeed);
    for (int j = 0; j <= nv_; ++j) {
      for (int i = 0; i < columns(); ++i) {
        const double du = kJitter * (2.0 * dice.unit() - 1.0), dv = kJitter * (2.0 * dice.unit() - 1.0);
        const bool rim_u = !sheet_.closed && (i == 0 || i == nu_), rim_v = j == 0 || j == nv_;
        uv_.emplace_back((i + (rim_u ? 0.0 : du)) / nu_, (j + (rim_v ? 0.0 : dv)) / nv_);
        keep_.push_back(keep(uv_.back()));
      }
    }
  }

  // The shorter diagonal divides the cell.
  void add_cell(int i, int j) {
    const int a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
    const auto length = [&](int p, int q) { return (place(uv_[at(p)]) - place(uv_[at(q)])).norm(); };
    if (length(a, c) <= length(b, d)) {
      faces_.insert(faces_.end(), {{a, b, c}, {a, c, d}});
    } else {
      faces_.insert(faces_.end(), {{a, b, d}, {b, c, d}});
    }
  }

  // Returns the point at fraction t of the way from a to b; a tube is crossed at its seam.
  [[nodiscard]] Vec2 between(int a, int b, double t) const {
    Vec2 to = uv_[at(b)];
    if (sheet_.closed) to.x() -= std::round(to.x() - uv_[at(a)].x());
    return uv_[at(a)] + t * (to - uv_[at(a)]);
  }

  // Returns the fraction of the way from a to b at which `keep` changes its sign.
  [[nodiscard]] double root(int a, int b) const {
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      ((keep(between(a, b, middle)) > 0.0) == (keep_[at(a)] > 0.0) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  void snap() {
    std::map<int, std::pair<double, Vec2>> nearest;  // Each vertex has the fraction of an edge and the new position.
    for (const auto& f : faces_) {
      for (std::size_t s = 0; s < 3; ++s) {
        const int a = f[s], b = f[(s + 1) % 3];
        if ((keep_[at(a)] > 0.0) == (keep_[at(b)] > 0.0)) continue;
        const double t = root(a, b);
        const auto [vertex, share] = t < 0.5 ? std::pair{a, t} : std::pair{b, 1.0 - t};
        if (share > kSnap) continue;
        const auto [entry, is_new] = nearest.try_emplace(vertex, share, between(a, b, t));
        if (!is_new && share < entry->second.first) entry->second = {share, between(a, b, t)};
      }
    }
    for (const auto& [vertex, to] : nearest) {
      uv_[at(vertex)] = to.second;
      keep_[at(vertex)] = 0.0;
    }
  }

  int cut(int a, int b, Mesh& out) {
    const auto key = std::minmax(a, b);
    const auto [entry, is_new] = cuts_.try_emplace(key, static_cast<int>(out.vertices.size()));
    if (is_new) out.vertices.push_back(place(between(key.first, key.second, root(key.first, key.second))));
    return entry->second;
  }

  void clip(const std::array<int, 3>& face, Mesh& out) {
    const auto value = [&](std::size_t k) { return keep_[at(face[k % 3])]; };
    if (value(0) <= 0.0 && value(1) <= 0.0 && value(2) <= 0.0) return;
    std::vector<int> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      if (value(k) >= 0.0) corner.push_back(face[k]);
      if (value(k) * value(k + 1) < 0.0) corner.push_back(cut(face[k], face[(k + 1) % 3], out));
    }
    const auto length = [&](std::size_t p, std::size_t q) {
      return (out.vertices[at(corner[p])] - out.vertices[at(corner[q])]).norm();
    };
    if (corner.size() == 4 && length(1, 3) < length(0, 2)) std::ranges::rotate(corner, corner.begin() + 1);
    for (std::size_t k = 2; k < corner.size(); ++k) out.faces.push_back({corner[0], corner[k - 1], corner[k]});
  }

  const Sheet& sheet_;
  int nu_, nv_;
  std::vector<Vec2> uv_;
  std::vector<double> keep_;
  std::vector<std::array<int, 3>> faces_;
  std::map<std::pair<int, int>, int> cuts_;  // Each edge that is cut has one vertex.
};

}  // namespace

Mesh without_unused_vertices(const Mesh& mesh) {
  Mesh out;
  std::vector<int> to(mesh.vertices.size(), -1);
  for (auto face : mesh.faces) {
    for (int& v : face) {
      int& kept = to[at(v)];
      if (kept < 0) {
        kept = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[at(v)]);
      }
      v = kept;
    }
    out.faces.push_back(face);
  }
  return out;
}

// The cut removes an area that is not known beforehand, so the number of cells is corrected twice.
Mesh mesh_of(const Sheet& sheet, int faces) {
  double cells = 0.5 * faces;
  Mesh mesh;
  for (int round = 0; round < 3; ++round) {
    const int nv = std::max(3, static_cast<int>(std::lround(std::sqrt(cells / sheet.aspect))));
    const int nu = std::max(3, static_cast<int>(std::lround(cells / nv)));
    mesh = Grid(sheet, nu, nv).mesh();
    cells *= static_cast<double>(faces) / static_cast<double>(std::max<std::size_t>(1, mesh.faces.size()));
  }
  return mesh;
}

}  // namespace triskin::mesh
