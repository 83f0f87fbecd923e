// SPDX-License-Identifier: GPL-3.0-or-later
#include "branch_and_bound.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "cell_bounds.hpp"

namespace triskin::geometry {
namespace {

constexpr double kPeriod_rad = 1.0471975511965976;  // the grid repeats after 60°

// Undecided tiles, each with the edges that may still cut it; shared by the children of a cell, which filter it.
struct TileList {
  struct Entry {
    Tile tile;
    Vec2 center;
    std::uint32_t first = 0, count = 0;  // range in `edges`
  };
  std::vector<Entry> tiles;
  std::vector<int> edges;
};

struct Cell {
  MotionBox box;
  int certain = 0;
  int undecided = 0;
  std::shared_ptr<const TileList> list;  // none: a root cell gets its tiles when it is looked at
  [[nodiscard]] int bound() const { return certain + undecided; }
};

double square_distance(const Vec2& p, const MovedEdge& e) {
  const Vec2 d = p - e.end[0];
  const double t = std::clamp(d.dot(e.along) * e.inverse_square, 0.0, 1.0);
  return (d - t * e.along).squaredNorm();
}

// Clips the cell to where at least `need` of the boxes overlap, one axis after the other. False: nowhere.
class Contraction {
 public:
  bool clip(MotionBox& box, const std::vector<OffsetBox>& boxes, int need) {
    if (static_cast<int>(boxes.size()) < need) return false;
    Eigen::Array3d low = -box.half, high = box.half;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (!sweep(boxes, axis, box.half[a], need, low[a], high[a])) return false;
    }
    box.center += 0.5 * (low + high);
    box.half = 0.5 * (high - low) * (1.0 + 1e-12) + 1e-15;
    return true;
  }

 private:
  // Coverage is counted in bins; a box covers every bin that it touches, so that the count can only be too high.
  bool sweep(const std::vector<OffsetBox>& boxes, std::size_t axis, double half, int need, double& low, double& high) {
    if (!(half > 1e-14)) return true;
    const double scale = 0.5 * kBins / half;
    change_.fill(0);
    for (const OffsetBox& b : boxes) {
      ++change_[bin((b.low[axis] + half) * scale - 1e-9)];
      --change_[bin((b.high[axis] + half) * scale + 1e-9) + 1];
    }
    int depth = 0, first = -1, last = -1;
    for (int k = 0; k < kBins; ++k) {
      depth += change_[static_cast<std::size_t>(k)];
      if (depth < need) continue;
      if (first < 0) first = k;
      last = k;
    }
    if (first < 0) return false;
    if (first > 0) low = first / scale - half;
    if (last + 1 < kBins) high = (last + 1) / scale - half;
    return true;
  }

  static std::size_t bin(double position) { return static_cast<std::size_t>(std::clamp(static_cast<int>(position), 0, kBins - 1)); }

  static constexpr int kBins = 64;
  std::array<int, kBins + 1> change_{};
};

class Search {
 public:
  Search(const PreparedPolygon& polygon, const SearchGoal& goal, const ProgressSink& progress)
      : polygon_(polygon), goal_(goal), sufficient_(goal.inset_mm - goal.tolerance_mm), progress_(progress),
        height_(goal.pitch_mm * 0.86602540378443864676) {
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
        if (std::chrono::steady_clock::now() > goal_.deadline) break;
        report(progress_, "placing", -1.0, fmt::format("{} modules, bound {}", result_.best, result_.upper_bound));
      }
      Cell cell = std::move(bucket->second.back());
      bucket->second.pop_back();
      if (bucket->second.empty()) open_.erase(bucket);
      expand(cell);
    }
    for (const auto& [bound, cells] : open_) {
      for (const Cell& cell : cells) close(cell.box);
    }
    const int open_bound = open_.empty() ? 0 : std::min(open_.begin()->first, area_bound_);
    result_.upper_bound = std::max({result_.best, open_bound, unresolved_bound_});
    return result_;
  }

 private:
  // A cell that the search is done with: part of the proof.
  void close(const MotionBox& box) { close(box, -box.half, box.half); }
  void close(const MotionBox& box, const Eigen::Array3d& low, const Eigen::Array3d& high) {
    if (goal_.cells == nullptr) return;
    std::array<double, 6> cell{};
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(2 * k);
      cell[at] = box.center[k] + low[k] - 1e-13;
      cell[at + 1] = box.center[k] + high[k] + 1e-13;
    }
    goal_.cells->push_back(cell);
  }

  void push(Cell cell) {
    const int bound = cell.list ? cell.bound() : area_bound_;
    if (bound > result_.best) open_[bound].push_back(std::move(cell));
    else close(cell.box);
  }

  void add_roots() {
    double twice_area = 0.0;
    for (const auto& [a, b] : polygon_.edges) twice_area += a.x() * b.y() - a.y() * b.x();
    area_bound_ = static_cast<int>(std::floor(0.5 * twice_area / kModuleArea_mm2 * (1.0 + 1e-6) + 1e-3));
    // Angles over which the farthest vertex moves by about half a module: short lists from the start.
    const int n = std::clamp(static_cast<int>(std::ceil(kPeriod_rad * polygon_.radius_mm / 24.0)), 1, 4096);
    for (int k = n - 1; k >= 0; --k) {
      Cell cell;
      cell.box.center = {0.5 * goal_.pitch_mm, 0.5 * height_, kPeriod_rad * (k + 0.5) / n};
      cell.box.half = {0.5 * goal_.pitch_mm, 0.5 * height_, 0.5 * kPeriod_rad / n * (1.0 + 1e-12)};
      push(std::move(cell));
    }
  }

  [[nodiscard]] CellFrame frame(const MotionBox& box) const { return {box, polygon_.radius_mm, goal_.inset_mm, sufficient_}; }

  // Tiles near the moved polygon, each with the edges near it.
  void seed(Cell& cell) {
    const CellFrame f = frame(cell.box);
    const double span = f.reach_mm + kCircumradius_mm + std::max(0.0, goal_.inset_mm) + 1e-6;
    std::map<Tile, std::vector<int>> near;
    Vec2 low = Vec2::Constant(1e300), high = -low;
    for (std::size_t k = 0; k < polygon_.edges.size(); ++k) {
      const MovedEdge e = f.move(polygon_.edges[k]);
      low = low.cwiseMin(e.end[0]);
      high = high.cwiseMax(e.end[0]);
      for_each_tile(e.end[0].cwiseMin(e.end[1]).array() - span, e.end[0].cwiseMax(e.end[1]).array() + span, [&](const Tile& t) {
        if (square_distance(center_of(t), e) <= span * span) near[t].push_back(static_cast<int>(k));
      });
    }
    const Vec2 margin = Vec2::Constant(f.reach_mm);
    for_each_tile((low - margin).array(), (high + margin).array(), [&](const Tile& t) {
      if (!near.contains(t) && center_inside(center_of(t), f)) ++cell.certain;
    });
    auto list = std::make_shared<TileList>();
    for (const auto& [tile, edges] : near) {
      list->tiles.push_back({tile, center_of(tile), static_cast<std::uint32_t>(list->edges.size()), static_cast<std::uint32_t>(edges.size())});
      list->edges.insert(list->edges.end(), edges.begin(), edges.end());
    }
    cell.undecided = static_cast<int>(list->tiles.size());
    cell.list = std::move(list);
  }

  [[nodiscard]] Vec2 center_of(const Tile& t) const {
    return {goal_.pitch_mm * (t.i + 0.5 * t.j + (t.up ? 0.5 : 1.0)), height_ * (t.j + (t.up ? 1.0 : 2.0) / 3.0)};
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

  [[nodiscard]] bool center_inside(const Vec2& q, const CellFrame& f) const {
    const Vec2 d = q - Vec2(f.box.center[0], f.box.center[1]);
    return polygon_.contains({f.cosine * d.x() + f.sine * d.y(), -f.sine * d.x() + f.cosine * d.y()});
  }

  const MovedEdge& moved(int edge, const CellFrame& f) {
    const auto k = static_cast<std::size_t>(edge);
    if (moved_at_[k] != stamp_) {
      moved_[k] = f.move(polygon_.edges[k]);
      moved_at_[k] = stamp_;
    }
    return moved_[k];
  }

  // Decides what can be decided in the cell: kept_ and boxes_ hold what stays open and where it may hold.
  // False as soon as too few tiles are left.
  bool filter(Cell& cell, int& inside_now) {
    ++stamp_;
    const CellFrame f = frame(cell.box);
    kept_.tiles.clear();
    kept_.edges.clear();
    boxes_.clear();
    int spare = cell.bound() - result_.best;
    for (const TileList::Entry& entry : cell.list->tiles) {
      OffsetBox feasible{{-f.box.half[0], -f.box.half[1], -f.box.half[2]}, {f.box.half[0], f.box.half[1], f.box.half[2]}};
      bool free_at_center = true;
      const auto first = static_cast<std::uint32_t>(kept_.edges.size());
      const bool possible = filter_tile(*cell.list, entry, f, feasible, free_at_center);
      const auto count = static_cast<std::uint32_t>(kept_.edges.size()) - first;
      const bool inside = possible && (count == 0 || free_at_center) && center_inside(entry.center, f);
      if (!possible || (count == 0 && !inside)) {
        kept_.edges.resize(first);
        if (--spare <= 0) return false;
      } else if (count == 0) {  // no edge can reach it: inside in the whole cell
        ++cell.certain;
      } else {
        inside_now += inside ? 1 : 0;
        kept_.tiles.push_back({entry.tile, entry.center, first, count});
        boxes_.push_back(feasible);
      }
    }
    cell.undecided = static_cast<int>(kept_.tiles.size());
    return true;
  }

  // False when the tile can hold nowhere in the cell; else appends the edges that may still cut it to kept_.
  bool filter_tile(const TileList& list, const TileList::Entry& entry, const CellFrame& f, OffsetBox& feasible, bool& free_at_center) {
    // The inscribed circle must stay free, and an edge beyond the circumscribed one cannot cut.
    const double inner = kInradius_mm - 1e-6 - f.reach_mm, outer = kCircumradius_mm + std::max(0.0, goal_.inset_mm) + 1e-6 + f.reach_mm;
    double nearest = 1e300;
    const std::size_t first = kept_.edges.size();
    for (std::uint32_t k = entry.first; k < entry.first + entry.count; ++k) {
      const MovedEdge& e = moved(list.edges[k], f);
      const double square = square_distance(entry.center, e);
      nearest = std::min(nearest, square);
      if (inner > 0.0 && square < inner * inner) return false;
      if (square > outer * outer) continue;
      switch (judge(f, entry.center, entry.tile.up, e, feasible, free_at_center)) {
        case EdgeVerdict::kAlwaysCuts: return false;
        case EdgeVerdict::kMayCut: kept_.edges.push_back(list.edges[k]); break;
        case EdgeVerdict::kNeverCuts: break;
      }
    }
    // No edge passes the centre anywhere in the cell: outside is outside everywhere.
    const double limit = f.reach_mm + 1e-6;
    return kept_.edges.size() == first || nearest <= limit * limit || center_inside(entry.center, f);
  }

  void note_value(int value, const MotionBox& box) {
    ++result_.evaluations;
    if (value <= result_.best) return;
    // Count again at the very motion that is returned; the filtered lists are only a shortcut.
    const Motion motion{box.center[0], box.center[1], box.center[2]};
    const int counted = count_inside(polygon_, motion, sufficient_, goal_.pitch_mm);
    if (counted <= result_.best) return;
    result_.best = counted;
    result_.motion = motion;
    result_.found = true;
  }

  void expand(Cell& cell) {
    if (!cell.list) seed(cell);
    for (int pass = 0; pass < 8; ++pass) {
      ++result_.cells;
      int inside_now = 0;
      if (!filter(cell, inside_now)) return close(cell.box);
      note_value(cell.certain + inside_now, cell.box);
      if (cell.bound() <= result_.best) return close(cell.box);
      const double before = size(cell.box);
      const int need = result_.best + 1 - cell.certain;
      const MotionBox whole = cell.box;
      if (need > 0 && !contraction_.clip(cell.box, boxes_, need)) return close(whole);
      close_clipped(whole, cell.box);
      cell.list = std::make_shared<const TileList>(kept_);
      if (size(cell.box) > 0.7 * before) break;
    }
    split(cell);
  }

  // The slabs that a contraction cut off.
  void close_clipped(const MotionBox& whole, const MotionBox& clipped) {
    Eigen::Array3d low = -whole.half, high = whole.half;
    for (int k = 0; k < 3; ++k) {
      const double shift = clipped.center[k] - whole.center[k], new_low = shift - clipped.half[k], new_high = shift + clipped.half[k];
      Eigen::Array3d part = high;
      part[k] = new_low;
      if (new_low > low[k] + 1e-13) close(whole, low, part);
      part = low;
      part[k] = new_high;
      if (new_high < high[k] - 1e-13) close(whole, part, high);
      low[k] = new_low;
      high[k] = new_high;
    }
  }

  [[nodiscard]] double size(const MotionBox& box) const {
    return std::max({box.half[0], box.half[1], polygon_.radius_mm * box.half[2]});
  }

  void split(Cell& cell) {
    const Eigen::Array3d weighted = cell.box.half * Eigen::Array3d(1.0, 1.0, polygon_.radius_mm);
    Eigen::Index axis = 0;
    if (weighted.maxCoeff(&axis) < goal_.resolution_mm) {  // near the rounding pad: stays open in the bound
      unresolved_bound_ = std::max(unresolved_bound_, cell.bound());
      close(cell.box);
      return;
    }
    Cell other = cell;
    cell.box.half[axis] *= 0.5;
    other.box.half[axis] *= 0.5;
    cell.box.center[axis] -= cell.box.half[axis];
    other.box.center[axis] += other.box.half[axis];
    push(std::move(other));
    push(std::move(cell));
  }

  const PreparedPolygon& polygon_;
  const SearchGoal goal_;
  const double sufficient_;
  const ProgressSink& progress_;
  const double height_;
  int area_bound_ = 0;
  int unresolved_bound_ = 0;
  SearchResult result_;
  std::map<int, std::vector<Cell>, std::greater<>> open_;  // by bound; last in, first out inside
  std::vector<MovedEdge> moved_;
  std::vector<std::int64_t> moved_at_;
  std::int64_t stamp_ = 0;
  TileList kept_;
  std::vector<OffsetBox> boxes_;
  Contraction contraction_;
};

}  // namespace

SearchResult branch_and_bound(const PreparedPolygon& polygon, const SearchGoal& goal, const ProgressSink& progress) {
  return Search(polygon, goal, progress).run();
}

}  // namespace triskin::geometry
