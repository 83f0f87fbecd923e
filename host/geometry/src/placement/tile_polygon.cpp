// SPDX-License-Identifier: GPL-3.0-or-later
#include "tile_polygon.hpp"

#include <algorithm>
#include <limits>

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

// A tile's shape around its centre: the same for all up tiles and for all down tiles.
struct TileShapeAround {
  std::array<Vec2, 3> normal, corner;
};

TileShapeAround shape_of(bool up, double pitch_mm) {
  const TileGeometry g = tile_geometry({0, 0, up}, pitch_mm);
  TileShapeAround s;
  for (std::size_t k = 0; k < 3; ++k) {
    s.normal[k] = g.normal[k];
    s.corner[k] = g.corner[k] - g.center;
  }
  return s;
}

// Marks the tiles that edges cut and collects where edges cross the rows' centre lines; flat arrays over the polygon's box.
class Rasterizer {
 public:
  Rasterizer(const std::vector<std::array<Vec2, 2>>& edges, double inset_mm, double pitch_mm)
      : inset_(inset_mm), pitch_(pitch_mm), height_(pitch_mm * 0.86602540378443864676),
        shape_{shape_of(false, pitch_mm), shape_of(true, pitch_mm)} {
    double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
    for (const auto& e : edges) {
      low_x = std::min(low_x, e[0].x());
      high_x = std::max(high_x, e[0].x());
      low_y = std::min(low_y, e[0].y());
      high_y = std::max(high_y, e[0].y());
    }
    const double reach = std::max(0.0, inset_);
    low_x_ = low_x - reach;
    first_row_ = row(low_y - reach) - 1;
    rows_ = row(high_y + reach) + 2 - first_row_;
    columns_ = static_cast<int>(std::ceil((high_x - low_x + 2 * reach) / pitch_)) + 8;
    cut_.assign(static_cast<std::size_t>(2 * rows_ * columns_), 0);
    crossings_.resize(static_cast<std::size_t>(2 * rows_));
    for (const auto& e : edges) add_edge(e[0], e[1]);
  }

  template <class Visit>
  void for_each_inside(Visit visit) {
    for (int r = 0; r < rows_; ++r) {
      for (const bool up : {false, true}) {
        auto& xs = crossings_[static_cast<std::size_t>(2 * r + (up ? 1 : 0))];
        std::ranges::sort(xs);
        const int j = first_row_ + r;
        // Centre of cell (i, j): up at x = a(i + j/2 + 1/2), down at a(i + j/2 + 1).
        const double shift = 0.5 * j + (up ? 0.5 : 1.0);
        for (std::size_t k = 0; k + 1 < xs.size(); k += 2) {
          const int last = static_cast<int>(std::floor(xs[k + 1] / pitch_ - shift));
          for (int i = static_cast<int>(std::ceil(xs[k] / pitch_ - shift)); i <= last; ++i) {
            if (cut_[index(i, j, up)] == 0) visit(Tile{i, j, up});
          }
        }
      }
    }
  }

 private:
  [[nodiscard]] int row(double y) const { return static_cast<int>(std::floor(y / height_)); }
  [[nodiscard]] double center_y(int j, bool up) const { return height_ * (j + (up ? 1.0 : 2.0) / 3.0); }
  [[nodiscard]] std::size_t index(int i, int j, bool up) const {
    const int first = static_cast<int>(std::floor(low_x_ / pitch_ - 0.5 * j)) - 3;
    const int column = std::clamp(i - first, 0, columns_ - 1);
    return static_cast<std::size_t>(2 * ((j - first_row_) * columns_ + column) + (up ? 1 : 0));
  }

  void add_edge(const Vec2& a, const Vec2& b) {
    mark_cut_tiles(a, b);
    const auto [low, high] = std::minmax(a.y(), b.y());
    for (int j = row(low) - 1; j <= row(high); ++j) {
      for (const bool up : {true, false}) {
        const double y = center_y(j, up);
        if ((a.y() > y) == (b.y() > y)) continue;
        crossings_[static_cast<std::size_t>(2 * (j - first_row_) + (up ? 1 : 0))].push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
  }

  [[nodiscard]] bool is_cut(bool up, const Vec2& center, const Vec2& a, const Vec2& b) const {
    const TileShapeAround& s = shape_[up ? 1 : 0];
    const Vec2 p = a - center, q = b - center;
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::min(s.normal[k].dot(p), s.normal[k].dot(q)) - kInradius_mm >= inset_) return false;
    }
    const Vec2 d = q - p;
    const double length = d.norm();
    if (!(length > 0.0)) return true;
    const Vec2 n(-d.y() / length, d.x() / length);
    double low = 1e300, high = -1e300;
    for (const Vec2& c : s.corner) {
      const double side = n.dot(c - p);
      low = std::min(low, side);
      high = std::max(high, side);
    }
    return std::max(low, -high) < inset_;
  }

  void mark_cut_tiles(const Vec2& a, const Vec2& b) {
    const double reach = std::max(0.0, inset_);
    const auto [low, high] = std::minmax(a.y(), b.y());
    for (int j = row(low - reach); j <= row(high + reach); ++j) {
      double x0 = a.x(), x1 = b.x();  // the part of the edge inside the row's strip, widened by the reach
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
          const Vec2 center(pitch_ * (i + 0.5 * j + (up ? 0.5 : 1.0)), center_y(j, up));
          if (is_cut(up, center, a, b)) cut_[index(i, j, up)] = 1;
        }
      }
    }
  }

  double inset_, pitch_, height_, low_x_ = 0.0;
  int first_row_ = 0, rows_ = 0, columns_ = 0;
  std::array<TileShapeAround, 2> shape_;
  std::vector<std::uint8_t> cut_;
  std::vector<std::vector<double>> crossings_;
};

std::vector<std::array<Vec2, 2>> moved_edges(const PreparedPolygon& polygon, const Motion& motion) {
  std::vector<std::array<Vec2, 2>> edges;
  edges.reserve(polygon.edges.size());
  const double c = std::cos(motion.theta), s = std::sin(motion.theta);
  const Vec2 shift(motion.x, motion.y);
  for (const auto& [a, b] : polygon.edges) edges.push_back({Vec2(rotate(a, c, s) + shift), Vec2(rotate(b, c, s) + shift)});
  return edges;
}

}  // namespace

std::vector<Tile> tiles_inside(const PreparedPolygon& polygon, const Motion& motion, double inset_mm, double pitch_mm) {
  std::vector<Tile> tiles;
  Rasterizer(moved_edges(polygon, motion), inset_mm, pitch_mm).for_each_inside([&](const Tile& t) { tiles.push_back(t); });
  std::ranges::sort(tiles);
  return tiles;
}

int count_inside(const PreparedPolygon& polygon, const Motion& motion, double inset_mm, double pitch_mm) {
  int n = 0;
  Rasterizer(moved_edges(polygon, motion), inset_mm, pitch_mm).for_each_inside([&](const Tile&) { ++n; });
  return n;
}

}  // namespace triskin::geometry
