// SPDX-License-Identifier: GPL-3.0-or-later
#include "tile_polygon.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

namespace triskin::geometry {
namespace {

Vec2 rotate(const Vec2& p, double c, double s) { return {c * p.x() - s * p.y(), s * p.x() + c * p.y()}; }

void add_ring(const std::vector<Vec2>& ring, const Vec2& first, std::vector<std::array<Vec2, 2>>& edges) {
  for (std::size_t k = 0; k < ring.size(); ++k) {
    edges.push_back({Vec2(ring[k] - first), Vec2(ring[(k + 1) % ring.size()] - first)});
  }
}

// Centre of a small enclosing circle: steps towards the farthest vertex (Bădoiu and Clarkson, 2003).
Vec2 enclosing_center(const std::vector<std::array<Vec2, 2>>& edges) {
  Vec2 center = edges.front()[0];
  for (int step = 1; step <= 200; ++step) {
    const auto far = std::ranges::max_element(edges, {}, [&](const auto& e) { return (e[0] - center).squaredNorm(); });
    center += ((*far)[0] - center) / (step + 1);
  }
  return center;
}

void fill_slabs(PreparedPolygon& p) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& e : p.edges) {
    low = std::min(low, e[0].y());
    high = std::max(high, e[0].y());
  }
  const std::size_t n = std::clamp<std::size_t>(p.edges.size(), 1, 4096);
  p.slab_low = low;
  p.slab_height = std::max((high - low) / static_cast<double>(n), 1e-12);
  p.slabs.assign(n, {});
  const auto slab_of = [&](double y) {
    return static_cast<std::size_t>(std::clamp((y - low) / p.slab_height, 0.0, static_cast<double>(n - 1)));
  };
  for (std::size_t k = 0; k < p.edges.size(); ++k) {
    const auto [y0, y1] = std::minmax(p.edges[k][0].y(), p.edges[k][1].y());
    for (std::size_t s = slab_of(y0); s <= slab_of(y1); ++s) p.slabs[s].push_back(static_cast<int>(k));
  }
}

}  // namespace

bool PreparedPolygon::contains(const Vec2& p) const {
  const double position = (p.y() - slab_low) / slab_height;
  if (position < 0.0 || position > static_cast<double>(slabs.size())) return false;
  const std::size_t slab = std::min(static_cast<std::size_t>(position), slabs.size() - 1);
  bool inside = false;
  for (const int k : slabs[slab]) {
    const auto& [a, b] = edges[static_cast<std::size_t>(k)];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

PreparedPolygon prepare(const Polygon& polygon) {
  PreparedPolygon p;
  p.first = polygon.outer.front();
  add_ring(polygon.outer, p.first, p.edges);
  for (const auto& hole : polygon.holes) add_ring(hole, p.first, p.edges);
  p.center = enclosing_center(p.edges);
  for (auto& e : p.edges) {
    for (Vec2& v : e) v -= p.center;
    p.radius_mm = std::max(p.radius_mm, e[0].norm());
  }
  fill_slabs(p);
  return p;
}

Placement to_placement(const PreparedPolygon& polygon, const Motion& motion) {
  const Vec2 moved = rotate(polygon.first + polygon.center, std::cos(motion.theta), std::sin(motion.theta));
  return {motion.x - moved.x(), motion.y - moved.y(), motion.theta};
}

TileGeometry tile_geometry(const Tile& tile, double pitch_mm) {
  TileGeometry g;
  Vec2 cell_center = Vec2::Zero();
  for (int c = 0; c < 3; ++c) {
    const auto [i, j] = tile_corner_index(tile, c);
    g.corner[static_cast<std::size_t>(c)] = grid_point(i, j, pitch_mm);
    cell_center += g.corner[static_cast<std::size_t>(c)] / 3.0;
  }
  g.center = cell_center;
  for (std::size_t c = 0; c < 3; ++c) g.corner[c] = g.center + (g.corner[c] - g.center) * (kSide_mm / pitch_mm);
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec2 d = (g.corner[(c + 1) % 3] - g.corner[c]) / kSide_mm;
    g.normal[c] = {d.y(), -d.x()};  // outward for counter-clockwise corners
    g.offset[c] = g.normal[c].dot(g.center) + kInradius_mm;
  }
  return g;
}

double separation(const TileGeometry& tile, const Vec2& a, const Vec2& b) {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    best = std::max(best, std::min(tile.normal[k].dot(a), tile.normal[k].dot(b)) - tile.offset[k]);
  }
  const Vec2 d = b - a;
  const double length = d.norm();
  if (!(length > 0.0)) return best;
  const Vec2 n(-d.y() / length, d.x() / length);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec2& c : tile.corner) {
    const double side = n.dot(c - a);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return std::max({best, low, -high});
}

namespace {

// Marks the tiles that an edge cuts and collects where it crosses the rows' centre lines.
class Rasterizer {
 public:
  Rasterizer(double inset_mm, double pitch_mm)
      : inset_(inset_mm), pitch_(pitch_mm), height_(pitch_mm * 0.86602540378443864676) {}

  void add_edge(const Vec2& a, const Vec2& b) {
    mark_cut_tiles(a, b);
    const auto [low, high] = std::minmax(a.y(), b.y());
    for (int j = row(low) - 1; j <= row(high) + 1; ++j) {
      for (const bool up : {true, false}) {
        const double y = center_y(j, up);
        if ((a.y() > y) == (b.y() > y)) continue;
        crossings_[{j, up}].push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
  }

  std::vector<Tile> inside() {
    std::vector<Tile> tiles;
    for (auto& [line, xs] : crossings_) {
      std::ranges::sort(xs);
      const auto [j, up] = line;
      // Centre of cell (i, j): up at x = a(i + j/2 + 1/2), down at a(i + j/2 + 1).
      const double shift = 0.5 * j + (up ? 0.5 : 1.0);
      for (std::size_t k = 0; k + 1 < xs.size(); k += 2) {
        const int first = static_cast<int>(std::ceil(xs[k] / pitch_ - shift));
        const int last = static_cast<int>(std::floor(xs[k + 1] / pitch_ - shift));
        for (int i = first; i <= last; ++i) {
          const Tile tile{i, j, up};
          if (!cut_.contains(tile)) tiles.push_back(tile);
        }
      }
    }
    std::ranges::sort(tiles);
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    return tiles;
  }

 private:
  [[nodiscard]] int row(double y) const { return static_cast<int>(std::floor(y / height_)); }
  [[nodiscard]] double center_y(int j, bool up) const { return height_ * (j + (up ? 1.0 : 2.0) / 3.0); }

  void mark_cut_tiles(const Vec2& a, const Vec2& b) {
    const double reach = std::max(0.0, inset_);
    const auto [low, high] = std::minmax(a.y(), b.y());
    for (int j = row(low - reach); j <= row(high + reach); ++j) {
      // Part of the edge inside the row's strip, widened by the reach and a half cell of slant.
      double x0 = a.x(), x1 = b.x();
      if (a.y() != b.y()) {
        const auto x_at = [&](double y) {
          const double t = std::clamp((y - a.y()) / (b.y() - a.y()), 0.0, 1.0);
          return a.x() + t * (b.x() - a.x());
        };
        x0 = x_at(height_ * j - reach);
        x1 = x_at(height_ * (j + 1) + reach);
      }
      const auto [left, right] = std::minmax(x0, x1);
      const int first = static_cast<int>(std::floor((left - reach) / pitch_ - 0.5 * j)) - 2;
      const int last = static_cast<int>(std::floor((right + reach) / pitch_ - 0.5 * j)) + 1;
      for (int i = first; i <= last; ++i) {
        for (const bool up : {true, false}) {
          const Tile tile{i, j, up};
          if (separation(tile_geometry(tile, pitch_), a, b) < inset_) cut_.insert(tile);
        }
      }
    }
  }

  double inset_, pitch_, height_;
  std::set<Tile> cut_;
  std::map<std::pair<int, bool>, std::vector<double>> crossings_;
};

}  // namespace

std::vector<Tile> tiles_inside(const PreparedPolygon& polygon, const Motion& motion, double inset_mm, double pitch_mm) {
  Rasterizer rasterizer(inset_mm, pitch_mm);
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  const Vec2 shift(motion.x, motion.y);
  for (const auto& [a, b] : polygon.edges) rasterizer.add_edge(rotate(a, c, s) + shift, rotate(b, c, s) + shift);
  return rasterizer.inside();
}

}  // namespace triskin::geometry
