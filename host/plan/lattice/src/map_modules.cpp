// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/lattice/map_modules.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "keep_limits.hpp"
#include "rigid.hpp"
#include "triskin/base/index.hpp"

namespace triskin::lattice {
namespace {

// Sorts the triangles of a flat piece into squares of a grid, so that those near a point are found without visiting
// all.
class TriangleGrid {
 public:
  // A triangle is near everything within `reach_mm` of its box.
  TriangleGrid(const std::vector<std::array<Vec2, 3>>& triangles, double reach_mm) : reach_mm_(reach_mm) {
    if (triangles.empty()) return;
    Vec2 high = triangles.front()[0];
    low_ = high;
    for (const auto& t : triangles) {
      boxes_.push_back({t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])});
      low_ = low_.cwiseMin(boxes_.back()[0]);
      high = high.cwiseMax(boxes_.back()[1]);
    }
    low_.array() -= reach_mm;
    high.array() += reach_mm;
    // There is about one square per triangle, and none is narrower than the reach.
    const Vec2 size = high - low_;
    side_mm_ = std::max({std::sqrt(size.prod() / static_cast<double>(triangles.size())), reach_mm, 1e-9 * size.norm()});
    for (int k = 0; k < 2; ++k) squares_[at(k)] = 1 + static_cast<int>(size[k] / side_mm_);
    near_.resize(at(squares_[0]) * at(squares_[1]));
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const auto from = square_of(boxes_[k][0].array() - reach_mm), to = square_of(boxes_[k][1].array() + reach_mm);
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int x = from[0]; x <= to[0]; ++x) near_[at(y * squares_[0] + x)].push_back(k);
      }
    }
  }

  // Calls visit(triangle) for those near the point, in their order.
  void each_near(const Vec2& p, const auto& visit) const {
    if (near_.empty()) return;
    const auto square = square_of(p);
    for (const std::size_t k : near_[at(square[1] * squares_[0] + square[0])]) {
      if ((p - boxes_[k][0]).minCoeff() >= -reach_mm_ && (boxes_[k][1] - p).minCoeff() >= -reach_mm_) visit(k);
    }
  }

 private:
  // A point outside gets the nearest square at the border of the grid.
  [[nodiscard]] std::array<int, 2> square_of(const Vec2& p) const {
    std::array<int, 2> square{};
    for (int k = 0; k < 2; ++k) {
      const double x = std::floor((p[k] - low_[k]) / side_mm_);
      square[at(k)] = static_cast<int>(std::clamp(x, 0.0, squares_[at(k)] - 1.0));
    }
    return square;
  }

  double reach_mm_, side_mm_ = 1.0;
  Vec2 low_ = Vec2::Zero();
  std::array<int, 2> squares_{};
  std::vector<std::array<Vec2, 2>> boxes_;
  std::vector<std::vector<std::size_t>> near_;
};

// Maps a point of the flat piece to a point of the surface.
class PieceMap {
 public:
  // Grid vertices may lie outside the piece by `overhang_mm`.
  PieceMap(const mesh::Surface& surface, const TiledPiece& placed, double overhang_mm)
      : surface_(surface), placed_(placed), overhang_mm_(overhang_mm), grid_(placed.piece->flat, 1.0 + overhang_mm) {}

  [[nodiscard]] Vec3 at_grid_vertex(int i, int j) const {
    const double c = std::cos(placed_.placement.theta_rad), s = std::sin(placed_.placement.theta_rad);
    const Vec2 d = grid_point(i, j) - Vec2(placed_.placement.x_mm, placed_.placement.y_mm);
    return at_flat({c * d.x() + s * d.y(), -s * d.x() + c * d.y()});
  }

 private:
  // Uses the triangle that contains the point, or (rounding at the border) misses it least.
  [[nodiscard]] Vec3 at_flat(const Vec2& p) const {
    double best = -1e300;
    Vec3 best_weights = Vec3::Zero();
    std::size_t best_triangle = 0;
    grid_.each_near(p, [&](std::size_t k) {
      const auto& t = placed_.piece->flat[k];
      const auto area = [](const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); };
      const double total = area(t[1] - t[0], t[2] - t[0]);
      const Vec3 w(area(t[1] - p, t[2] - p) / total, area(t[2] - p, t[0] - p) / total,
                   area(t[0] - p, t[1] - p) / total);
      const double inside = overhang_mm_ > 0.0 ? min_height_mm(t, w, total) : w.minCoeff();
      if (inside > best) {
        best = inside;
        best_weights = w;
        best_triangle = k;
      }
    });
    const auto& face = surface_.mesh().faces[at(placed_.piece->faces[best_triangle])];
    const auto& v = surface_.mesh().vertices;
    return best_weights[0] * v[at(face[0])] + best_weights[1] * v[at(face[1])] + best_weights[2] * v[at(face[2])];
  }

  // Returns how far inside a triangle a point with these weights lies, negative outside: small triangles near the point
  // must not lose against large ones far away.
  static double min_height_mm(const std::array<Vec2, 3>& t, const Vec3& weights, double twice_area) {
    double least = 1e300;
    for (int k = 0; k < 3; ++k)
      least = std::min(least, weights[k] * std::abs(twice_area) / (t[at((k + 2) % 3)] - t[at((k + 1) % 3)]).norm());
    return least;
  }

  const mesh::Surface& surface_;
  const TiledPiece& placed_;
  double overhang_mm_;
  TriangleGrid grid_;
};

class Mapper {
 public:
  Mapper(const mesh::Surface& surface, const LayoutLimits& limits, double corner_cut_mm,
         const mesh::SurfaceRegions* regions)
      : surface_(surface), limits_(limits), regions_(regions), overhang_mm_(design::cut_height_mm(corner_cut_mm)) {
    layout_.method = LayoutMethod::kPieces;
    layout_.corner_cut_mm = corner_cut_mm;
  }

  // Pieces have no joints in common, so they are mapped one after another while time remains.
  ModuleLayout run(const std::vector<TiledPiece>& pieces, const std::function<bool()>& give_up) {
    constexpr std::size_t kTogether = 1000;  // This many modules give all processors work.
    std::size_t mapped = 0;
    int left_out = 0;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      if (mapped > 0 && give_up && give_up()) {
        left_out += static_cast<int>(pieces[p].tiles.size());
        continue;
      }
      add_piece(pieces[p], static_cast<int>(p));
      if (layout_.modules.size() < mapped + kTogether) continue;
      relax_and_measure(mapped);
      mapped = layout_.modules.size();
    }
    relax_and_measure(mapped);
    if (left_out > 0) layout_.refused.emplace_back("time_limit", left_out);
    keep_limits_as_measured(surface_, limits_, layout_);
    return std::move(layout_);
  }

 private:
  void add_piece(const TiledPiece& placed, int piece) {
    const PieceMap map(surface_, placed, overhang_mm_);
    std::map<Tile, int> index;
    for (const Tile& tile : placed.tiles) {
      PlacedModule m;
      m.tile = tile;
      m.island = piece;
      for (int c = 0; c < 3; ++c) {
        const auto [i, j] = tile_corner_index(tile, c);
        m.corner_mm[at(c)] = map.at_grid_vertex(i, j);
      }
      m.corner_mm = fit_rigid(m.corner_mm);
      index[tile] = static_cast<int>(layout_.modules.size());
      layout_.modules.push_back(m);
    }
    for (const auto& [tile, k] : index) {
      for (int s = 0; s < 3; ++s) {
        const auto found = index.find(across(tile, s).tile);
        if (found != index.end()) layout_.modules[at(k)].neighbour[at(s)] = found->second;
      }
    }
  }

  // Relaxes the modules from `first` on: joined corners pull each other together on the surface; the modules stay
  // rigid.
  void relax_and_measure(std::size_t first) {
    const std::size_t n = layout_.modules.size() - first;
    std::vector<std::array<Vec3, 3>> fitted(n);
    const Vec3 anywhere = surface_.mesh().vertices.empty() ? Vec3(Vec3::Zero()) : surface_.mesh().vertices.front();
    std::vector<std::array<Vec3, 3>> feet(n, {anywhere, anywhere, anywhere});
    for (int step = 0; step < 40; ++step) {
      tbb::parallel_for(std::size_t{0}, n, [&](std::size_t k) {
        const PlacedModule& m = layout_.modules[first + k];
        std::array<Vec3, 3> target;
        for (int c = 0; c < 3; ++c)
          target[at(c)] = 0.7 * pulled_corner(m, c, feet[k][at(c)]) + 0.3 * m.corner_mm[at(c)];
        fitted[k] = fit_rigid(target);
      });
      for (std::size_t k = 0; k < n; ++k) layout_.modules[first + k].corner_mm = fitted[k];
    }
    measure_modules(surface_, layout_, first, regions_);
  }

  [[nodiscard]] Vec3 pulled_corner(const PlacedModule& m, int c, Vec3& foot) const {
    Vec3 sum = m.corner_mm[at(c)];
    int n = 1;
    // Corner c ends side c and begins side c + 2.
    for (const int s : {c, (c + 2) % 3}) {
      if (m.neighbour[at(s)] < 0) continue;
      const int t = across(m.tile, s).side;
      sum += layout_.modules[at(m.neighbour[at(s)])].corner_mm[at(s == c ? (t + 1) % 3 : t)];
      ++n;
    }
    return held_to_surface(surface_, sum / n, overhang_mm_, foot);
  }

  const mesh::Surface& surface_;
  const LayoutLimits limits_;
  const mesh::SurfaceRegions* regions_;
  const double overhang_mm_;  // Corners may overhang the border by this much because they are cut off.
  ModuleLayout layout_;
};

}  // namespace

ModuleLayout map_modules(const mesh::Surface& surface, const std::vector<TiledPiece>& pieces,
                         const LayoutLimits& limits, double corner_cut_mm, const mesh::SurfaceRegions* regions,
                         const std::function<bool()>& give_up) {
  return Mapper(surface, limits, corner_cut_mm, regions).run(pieces, give_up);
}

}  // namespace triskin::lattice
