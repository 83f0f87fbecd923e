// SPDX-License-Identifier: GPL-3.0-or-later
#include "branch_and_bound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "cell_bounds.hpp"

namespace triskin::geometry {
namespace {

constexpr double kPeriod_rad = 1.0471975511965976;  // the grid repeats after 60°

struct UndecidedTile {
  Tile tile;
  TileGeometry geometry;
  std::vector<int> edges;  // those that may still cut it
};

struct Cell {
  MotionBox box;
  int certain = 0;
  std::vector<UndecidedTile> tiles;
  bool seeded = false;  // a root cell gets its tiles when it is looked at
  [[nodiscard]] int bound() const { return certain + static_cast<int>(tiles.size()); }
};

double segment_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double squared = d.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((p - a).dot(d) / squared, 0.0, 1.0) : 0.0;
  return (a + t * d - p).norm();
}

class Search {
 public:
  Search(const PreparedPolygon& polygon, const SearchGoal& goal, const ProgressSink& progress)
      : polygon_(polygon), goal_(goal), progress_(progress), height_(goal.pitch_mm * 0.86602540378443864676) {
    result_.best = goal.known;
    moved_.resize(polygon.edges.size());
    moved_at_.assign(polygon.edges.size(), -1);
  }

  SearchResult run() {
    add_roots();
    while (!open_.empty()) {
      auto bucket = open_.begin();
      result_.upper_bound = std::max(result_.best, std::min(bucket->first, area_bound_));
      if (bucket->first <= result_.best || (goal_.stop_at_first && result_.found)) break;
      if ((result_.cells & 63) == 0) {
        if (std::chrono::steady_clock::now() > goal_.deadline) return result_;
        report(progress_, "placing", -1.0, fmt::format("{} modules, bound {}", result_.best, result_.upper_bound));
      }
      std::unique_ptr<Cell> cell = std::move(bucket->second.back());
      bucket->second.pop_back();
      if (bucket->second.empty()) open_.erase(bucket);
      expand(std::move(cell));
    }
    const int open_bound = open_.empty() ? 0 : std::min(open_.begin()->first, area_bound_);
    result_.upper_bound = std::max({result_.best, open_bound, unresolved_bound_});
    return result_;
  }

 private:
  void push(std::unique_ptr<Cell> cell) {
    const int bound = cell->seeded ? cell->bound() : area_bound_;
    if (bound > result_.best) open_[bound].push_back(std::move(cell));
  }

  void add_roots() {
    double twice_area = 0.0;
    for (const auto& [a, b] : polygon_.edges) twice_area += a.x() * b.y() - a.y() * b.x();
    area_bound_ = static_cast<int>(std::floor(0.5 * twice_area / kModuleArea_mm2 * (1.0 + 1e-6) + 1e-3));
    // Angles over which the farthest vertex moves by about half a module: short lists from the start.
    const int n = std::clamp(static_cast<int>(std::ceil(kPeriod_rad * polygon_.radius_mm / 24.0)), 1, 4096);
    for (int k = n - 1; k >= 0; --k) {
      auto cell = std::make_unique<Cell>();
      cell->box.center = {0.5 * goal_.pitch_mm, 0.5 * height_, kPeriod_rad * (k + 0.5) / n};
      cell->box.half = {0.5 * goal_.pitch_mm, 0.5 * height_, 0.5 * kPeriod_rad / n * (1.0 + 1e-12)};
      push(std::move(cell));
    }
  }

  // How far any point of the polygon can move inside the cell.
  [[nodiscard]] double reach(const MotionBox& box) const {
    return std::hypot(box.half[0], box.half[1]) + polygon_.radius_mm * box.half[2];
  }

  // Tiles near the moved polygon, each with the edges near it.
  void seed(Cell& cell) {
    const double span = reach(cell.box) + kCircumradius_mm + std::max(0.0, goal_.inset_mm);
    std::map<Tile, std::vector<int>> near;
    Vec2 low = Vec2::Constant(1e300), high = -low;
    for (std::size_t k = 0; k < polygon_.edges.size(); ++k) {
      const MovedEdge e = move_edge(polygon_.edges[k], cell.box);
      low = low.cwiseMin(e.end[0]);
      high = high.cwiseMax(e.end[0]);
      for_each_tile(e.end[0].cwiseMin(e.end[1]).array() - span, e.end[0].cwiseMax(e.end[1]).array() + span, [&](const Tile& t) {
        const TileGeometry g = tile_geometry(t, goal_.pitch_mm);
        if (segment_distance(g.center, e.end[0], e.end[1]) <= span) near[t].push_back(static_cast<int>(k));
      });
    }
    const Vec2 margin = Vec2::Constant(reach(cell.box));
    for_each_tile((low - margin).array(), (high + margin).array(), [&](const Tile& t) {
      if (!near.contains(t) && center_inside(tile_geometry(t, goal_.pitch_mm).center, cell.box)) ++cell.certain;
    });
    for (auto& [tile, edges] : near) cell.tiles.push_back({tile, tile_geometry(tile, goal_.pitch_mm), std::move(edges)});
    cell.seeded = true;
  }

  template <class Visit>
  void for_each_tile(const Eigen::Array2d& low, const Eigen::Array2d& high, Visit visit) const {
    const int j0 = static_cast<int>(std::floor(low.y() / height_)), j1 = static_cast<int>(std::floor(high.y() / height_));
    for (int j = j0; j <= j1; ++j) {
      const int i0 = static_cast<int>(std::floor(low.x() / goal_.pitch_mm - 0.5 * j)) - 2;
      const int i1 = static_cast<int>(std::floor(high.x() / goal_.pitch_mm - 0.5 * j)) + 1;
      for (int i = i0; i <= i1; ++i) {
        for (const bool up : {true, false}) visit(Tile{i, j, up});
      }
    }
  }

  [[nodiscard]] bool center_inside(const Vec2& q, const MotionBox& box) {
    if (box.center[2] != turned_to_) {
      turned_to_ = box.center[2];
      cosine_ = std::cos(turned_to_);
      sine_ = std::sin(turned_to_);
    }
    const Vec2 d = q - Vec2(box.center[0], box.center[1]);
    return polygon_.contains({cosine_ * d.x() + sine_ * d.y(), -sine_ * d.x() + cosine_ * d.y()});
  }

  const MovedEdge& moved(int edge, const MotionBox& box) {
    const auto k = static_cast<std::size_t>(edge);
    if (moved_at_[k] != stamp_) {
      moved_[k] = move_edge(polygon_.edges[k], box);
      moved_at_[k] = stamp_;
    }
    return moved_[k];
  }

  // Decides what can be decided in the cell. Returns the box of offsets in which each remaining tile may hold.
  std::vector<OffsetBox> filter(Cell& cell, int& inside_now) {
    ++stamp_;
    std::vector<OffsetBox> boxes;
    std::size_t kept = 0;
    const double reach_mm = reach(cell.box);
    for (std::size_t t = 0; t < cell.tiles.size(); ++t) {
      UndecidedTile& u = cell.tiles[t];
      OffsetBox feasible{-cell.box.half, cell.box.half};
      if (!filter_tile(u, cell.box, reach_mm, feasible)) continue;
      const bool inside = center_inside(u.geometry.center, cell.box);
      if (u.edges.empty()) {  // no edge can reach it: the same answer in the whole cell
        if (inside) ++cell.certain;
        continue;
      }
      if (inside && holds_at_center(u, cell.box)) ++inside_now;
      if (kept != t) cell.tiles[kept] = std::move(u);
      ++kept;
      boxes.push_back(feasible);
    }
    cell.tiles.resize(kept);
    return boxes;
  }

  // False when the tile can hold nowhere in the cell.
  bool filter_tile(UndecidedTile& u, const MotionBox& box, double reach_mm, OffsetBox& feasible) {
    std::size_t kept = 0;
    double nearest = 1e300;
    for (const int k : u.edges) {
      const MovedEdge& e = moved(k, box);
      const double distance = segment_distance(u.geometry.center, e.end[0], e.end[1]);
      nearest = std::min(nearest, distance);
      // The inscribed circle must stay free, and an edge beyond the circumscribed one cannot cut.
      if (distance + reach_mm < kInradius_mm + std::min(0.0, goal_.inset_mm) - 1e-6) return false;
      if (distance - reach_mm > kCircumradius_mm + std::max(0.0, goal_.inset_mm) + 1e-6) continue;
      switch (judge(u.geometry, e, box, goal_.inset_mm, feasible)) {
        case EdgeVerdict::kAlwaysCuts: return false;
        case EdgeVerdict::kMayCut: u.edges[kept++] = k; break;
        case EdgeVerdict::kNeverCuts: break;
      }
    }
    // Outside by more than the polygon can move, and in the first place nearer edges were dropped as harmless.
    if (kept > 0 && nearest > reach_mm && !center_inside(u.geometry.center, box)) return false;
    u.edges.resize(kept);
    return true;
  }

  bool holds_at_center(const UndecidedTile& u, const MotionBox& box) {
    return std::ranges::all_of(u.edges, [&](int k) {
      const MovedEdge& e = moved(k, box);
      return separation(u.geometry, e.end[0], e.end[1]) >= goal_.inset_mm;
    });
  }

  void note_value(int value, const MotionBox& box) {
    ++result_.evaluations;
    if (value <= result_.best) return;
    // Count again at the very motion that is returned; the filtered lists are only a shortcut.
    const Motion motion{box.center[0], box.center[1], box.center[2]};
    const int counted = count_inside(polygon_, motion, goal_.inset_mm, goal_.pitch_mm);
    if (counted <= result_.best) return;
    result_.best = counted;
    result_.motion = motion;
    result_.found = true;
  }

  // Clips the cell to where at least `need` of the boxes overlap, one axis after the other. False: nowhere.
  static bool contract(MotionBox& box, const std::vector<OffsetBox>& boxes, int need) {
    if (static_cast<int>(boxes.size()) < need) return false;
    Eigen::Array3d low = -box.half, high = box.half;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<std::pair<double, int>> ends;
      ends.reserve(2 * boxes.size());
      for (const OffsetBox& b : boxes) {
        ends.emplace_back(b.low[axis], 0);  // at one place, begins stand before ends
        ends.emplace_back(b.high[axis], 1);
      }
      std::ranges::sort(ends);
      int depth = 0;
      double first = 1e300, last = -1e300;
      for (const auto& [place, is_end] : ends) {
        if (is_end != 0) {
          if (depth-- == need) last = place;
        } else if (++depth == need) {
          first = std::min(first, place);
        }
      }
      if (first > last) return false;
      low[axis] = first;
      high[axis] = last;
    }
    box.center += 0.5 * (low + high);
    box.half = 0.5 * (high - low) * (1.0 + 1e-12) + 1e-15;
    return true;
  }

  void expand(std::unique_ptr<Cell> cell) {
    if (!cell->seeded) seed(*cell);
    for (int pass = 0; pass < 8; ++pass) {
      ++result_.cells;
      int inside_now = 0;
      const std::vector<OffsetBox> boxes = filter(*cell, inside_now);
      note_value(cell->certain + inside_now, cell->box);
      if (cell->bound() <= result_.best) return;
      const double before = size(cell->box);
      const int need = result_.best + 1 - cell->certain;
      if (need > 0 && !contract(cell->box, boxes, need)) return;
      if (size(cell->box) > 0.7 * before) break;
    }
    split(std::move(cell));
  }

  [[nodiscard]] double size(const MotionBox& box) const {
    return std::max({box.half[0], box.half[1], polygon_.radius_mm * box.half[2]});
  }

  void split(std::unique_ptr<Cell> cell) {
    const Eigen::Array3d weighted = cell->box.half * Eigen::Array3d(1.0, 1.0, polygon_.radius_mm);
    Eigen::Index axis = 0;
    if (weighted.maxCoeff(&axis) < goal_.resolution_mm) {  // near the rounding pad: stays open in the bound
      unresolved_bound_ = std::max(unresolved_bound_, cell->bound());
      return;
    }
    auto other = std::make_unique<Cell>(*cell);
    cell->box.half[axis] *= 0.5;
    other->box.half[axis] *= 0.5;
    cell->box.center[axis] -= cell->box.half[axis];
    other->box.center[axis] += other->box.half[axis];
    push(std::move(other));
    push(std::move(cell));
  }

  const PreparedPolygon& polygon_;
  const SearchGoal goal_;
  const ProgressSink& progress_;
  const double height_;
  int area_bound_ = 0;
  int unresolved_bound_ = 0;
  SearchResult result_;
  std::map<int, std::vector<std::unique_ptr<Cell>>, std::greater<>> open_;  // by bound; last in, first out inside
  std::vector<MovedEdge> moved_;
  std::vector<std::int64_t> moved_at_;
  std::int64_t stamp_ = 0;
  double turned_to_ = 1e300, cosine_ = 0.0, sine_ = 0.0;  // of the last angle that was asked for
};

}  // namespace

SearchResult branch_and_bound(const PreparedPolygon& polygon, const SearchGoal& goal, const ProgressSink& progress) {
  return Search(polygon, goal, progress).run();
}

}  // namespace triskin::geometry
