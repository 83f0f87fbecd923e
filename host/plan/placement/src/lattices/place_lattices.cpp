// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "kernels/evaluator.hpp"
#include "kernels/exact_recheck.hpp"
#include "kernels/tile_grid.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/placement/lattices.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

constexpr int kTries = 16;          // New lattices that are tried at once; the one with most modules stays.
constexpr double kHeat = 0.35;      // Modules that a step may lose, in the manner of annealing.
constexpr int kStepsAReturn = 400;  // After so many steps without a better layout the search returns to the best.
constexpr double kMinRuin_mm = 20.0, kMaxRuin_mm = 80.0;

using Corners = std::array<Vec2, 3>;

Vec2 turned(const Vec2& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

// Returns how far apart two triangles (counter-clockwise) are, or less: the largest gap along a normal of a side.
double separation(const Corners& a, const Corners& b) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const auto* t : {&a, &b}) {
    const Corners& other = t == &a ? b : a;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 side = (*t)[(k + 1) % 3] - (*t)[k], out = Vec2(side.y(), -side.x()) / side.norm();
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec2& p : other) nearest = std::min(nearest, out.dot(p - (*t)[k]));
      largest = std::max(largest, nearest);
    }
  }
  return largest;
}

// Everything in the search is in the recentred frame of the outline.
struct Module {
  std::size_t lattice;  // Index of its motion.
  Tile tile;
  Corners corner;
  Vec2 center;
};

double height(const Module& m) {
  return m.center.y();
}

/// Ruin and recreate: modules of a part of the outline are taken away, and the room is filled with whole lattices, each
/// laid on an edge of the outline, on a side of a module that stays, or anywhere.
class Search {
 public:
  Search(const PreparedPolygon& polygon, const LatticesOptions& options)
      : polygon_(polygon),
        options_(options),
        grid_(tile_grid(TileShape::kTriangle, options.gap_mm)),
        inside_(polygon, grid_),
        random_(options.seed) {}

  void begin(const FlatLattice& one) {
    motions_.push_back(to_motion(polygon_, one.placement));
    for (const Tile& tile : one.tiles) now_.push_back(module_at(0, tile));
    if (options_.max_lattices != 1) fill();
    best_ = now_;
  }

  void step() {
    const std::vector<Module> before = now_;
    ruin();
    fill();
    const double gained = static_cast<double>(now_.size()) - static_cast<double>(before.size());
    if (gained < kHeat * std::log(std::max(1e-12, unit()))) now_ = before;
    if (now_.size() > best_.size()) {
      best_ = now_;
      since_best_ = 0;
    } else if (++since_best_ >= kStepsAReturn) {
      now_ = best_;
      since_best_ = 0;
      forget_unused();
    }
  }

  [[nodiscard]] std::size_t modules() const { return best_.size(); }
  [[nodiscard]] std::vector<FlatLattice> lattices() const {
    std::map<std::size_t, std::vector<Tile>> tiles;
    for (const Module& m : best_) tiles[m.lattice].push_back(m.tile);
    std::vector<FlatLattice> list;
    for (auto& [lattice, of_lattice] : tiles) {
      std::ranges::sort(of_lattice);
      require_exact(polygon_, motions_[lattice], of_lattice, options_.tolerance_mm, grid_);
      list.push_back({to_placement(polygon_, motions_[lattice]), std::move(of_lattice)});
    }
    std::ranges::stable_sort(list, std::greater{}, [](const FlatLattice& l) { return l.tiles.size(); });
    return list;
  }

 private:
  double unit() { return std::generate_canonical<double, 53>(random_); }
  std::size_t below(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(unit() * static_cast<double>(count)));
  }

  Module module_at(std::size_t lattice, const Tile& tile) const {
    const Motion& m = motions_[lattice];
    const auto back = [&](const Vec2& q) { return turned(q - Vec2(m.x, m.y), -m.theta); };
    const Vec2 center = grid_.center(tile);
    Module module{lattice, tile, {}, back(center)};
    for (std::size_t k = 0; k < 3; ++k) module.corner[k] = back(center + (tile.up ? 1.0 : -1.0) * grid_.corner[k]);
    return module;
  }

  // Needs now_ sorted by height.
  [[nodiscard]] bool is_free(const Module& m) const {
    const double reach = 2.0 * grid_.circumradius_mm + options_.gap_mm;
    auto other = std::ranges::lower_bound(now_, m.center.y() - reach, {}, height);
    for (; other != now_.end() && height(*other) < m.center.y() + reach; ++other) {
      if ((m.center - other->center).squaredNorm() < reach * reach &&
          separation(m.corner, other->corner) < options_.gap_mm - options_.tolerance_mm)
        return false;
    }
    return true;
  }

  // Modules of a lattice that have room beside those that are there.
  std::vector<Module> room_for(std::size_t lattice) {
    std::vector<Module> found;
    for (const Tile& tile : inside_.tiles(motions_[lattice], -options_.tolerance_mm)) {
      const Module m = module_at(lattice, tile);
      if (is_free(m)) found.push_back(m);
    }
    return found;
  }

  // Adds the lattice that adds most, as long as one adds a module. Lattices that are there come first: they cost no new
  // one.
  void fill() {
    for (;;) {
      std::ranges::stable_sort(now_, {}, height);
      std::vector<std::size_t> there;
      for (const Module& m : now_) {
        if (std::ranges::find(there, m.lattice) == there.end()) there.push_back(m.lattice);
      }
      std::vector<Module> most;
      for (const std::size_t lattice : there) {
        if (auto found = room_for(lattice); found.size() > most.size()) most = std::move(found);
      }
      const bool may_add = options_.max_lattices == 0 || there.size() < static_cast<std::size_t>(options_.max_lattices);
      for (int k = 0; may_add && k < kTries; ++k) {
        motions_.push_back(some_motion());
        if (auto found = room_for(motions_.size() - 1); found.size() > most.size())
          most = std::move(found);
        else
          motions_.pop_back();
      }
      if (most.empty()) return;
      now_.insert(now_.end(), most.begin(), most.end());
    }
  }

  // Lays the grid with a row along a segment that has the free side on its left, `along_mm` from its start.
  Motion on_segment(const Vec2& from, const Vec2& to, double along_mm) const {
    const Vec2 d = (to - from).normalized(), place = from + along_mm * d;
    const double theta = -std::atan2(d.y(), d.x());
    Vec2 corner = grid_.corner[0];  // The lower left one of the up tile.
    for (std::size_t k = 1; k < 3; ++k) {
      const Vec2& c = grid_.corner[k];
      if (c.y() < corner.y() - 1.0 || (c.y() < corner.y() + 1.0 && c.x() < corner.x())) corner = c;
    }
    const Vec2 shift = grid_.center({0, 0, true}) + corner - turned(place, theta);
    return {shift.x(), shift.y(), theta};
  }

  Motion on_edge_of_outline() {
    const std::size_t k = below(polygon_.edges.size());
    const auto& [from, to] = polygon_.edges[k];
    const Vec2& after = polygon_.edges[polygon_.next[k]][1];
    // Where the first up or down tile of a row touches the edge that follows; the angle may be 0 or π.
    const Vec2 back = from - to, next = after - to;
    const double angle = std::atan2(std::abs(back.x() * next.y() - back.y() * next.x()), back.dot(next));
    const double foot_mm = kHeight_mm / std::tan(std::clamp(angle, 0.02, 3.0)), length_mm = back.norm();
    switch (below(4)) {
      case 0:
        return on_segment(from, to, 0.0);
      case 1:
        return on_segment(from, to, length_mm - foot_mm + kSide_mm / 2.0);
      case 2:
        return on_segment(from, to, length_mm - foot_mm - kSide_mm / 2.0);
      default:
        return on_segment(from, to, unit() * kSide_mm);
    }
  }

  Motion on_side_of_module() {
    const Module& m = now_[below(now_.size())];
    const std::size_t k = below(3);
    const Vec2 &a = m.corner[k], &b = m.corner[(k + 1) % 3];
    const Vec2 side = b - a, out = Vec2(side.y(), -side.x()) / side.norm() * options_.gap_mm;
    // Seen from outside the side runs the other way.
    return on_segment(b + out, a + out, below(2) == 0 ? 0.0 : unit() * kSide_mm);
  }

  Motion some_motion() {
    const double kind = unit();
    if (kind < 0.55) return on_edge_of_outline();
    if (kind < 0.85 && !now_.empty()) return on_side_of_module();
    const Vec2& a = polygon_.edges[below(polygon_.edges.size())][0];
    return on_segment(a, a + turned({1.0, 0.0}, unit() * 2.0 * std::numbers::pi), unit() * kSide_mm);
  }

  void ruin() {
    if (now_.empty()) return;
    const Module at = now_[below(now_.size())];
    const double kind = unit();
    const double radius = kMinRuin_mm + (kMaxRuin_mm - kMinRuin_mm) * unit() * unit();
    const Vec2 direction = turned({1.0, 0.0}, unit() * 2.0 * std::numbers::pi);
    std::erase_if(now_, [&](const Module& m) {
      if (kind < 0.6) return (m.center - at.center).norm() < radius;
      if (kind < 0.8) return direction.dot(m.center - at.center) >= 0.0;
      return m.lattice == at.lattice;
    });
  }

  // Motions of layouts that were given up would only take room.
  void forget_unused() {
    std::map<std::size_t, std::size_t> new_index;
    std::vector<Motion> used;
    for (Module& m : now_) {
      const auto [at, is_new] = new_index.try_emplace(m.lattice, used.size());
      if (is_new) used.push_back(motions_[m.lattice]);
      m.lattice = at->second;
    }
    motions_ = std::move(used);
    best_ = now_;
  }

  const PreparedPolygon& polygon_;
  const LatticesOptions& options_;
  TileGrid grid_;
  Evaluator inside_;
  std::mt19937_64 random_;
  std::vector<Motion> motions_;
  std::vector<Module> now_, best_;
  int since_best_ = 0;
};

void check_options(const LatticesOptions& o) {
  if (o.max_lattices < 0 || o.max_lattices > 1000) throw InputError("the number of lattices must be 0 … 1000");
  if (!(o.gap_mm >= 0.0 && o.gap_mm <= 100.0)) throw InputError("the gap must be 0 … 100 mm");
  if (!(o.tolerance_mm >= 1e-8 && o.tolerance_mm <= 1.0)) throw InputError("the tolerance must be 1e-8 … 1 mm");
  if (!(o.time_limit_s > 0.0)) throw InputError("several lattices need a time limit (--time-limit-s)");
  if (o.steps < 0) throw InputError("the number of steps must not be negative");
}

nlohmann::json ring_json(const std::vector<Vec2>& ring) {
  nlohmann::json list = nlohmann::json::array();
  for (const Vec2& p : ring) list.push_back({p.x(), p.y()});
  return list;
}

}  // namespace

FlatLayout place_lattices(const Polygon& given, const FlatLattice& one, const LatticesOptions& options,
                          const ProgressSink& progress) {
  check_options(options);
  const auto start = std::chrono::steady_clock::now();
  const auto used_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const Polygon polygon = normalize_polygon(given, "outline");
  const PreparedPolygon prepared = prepare(polygon);
  FlatLayout layout;
  layout.upper_bound = modules_bound(polygon, options.gap_mm, options.tolerance_mm);
  Search search(prepared, options);
  search.begin(one);
  const auto is_over = [&] {
    return options.max_lattices == 1 || static_cast<int>(search.modules()) >= layout.upper_bound ||
           (options.steps > 0 && layout.steps >= options.steps) || used_s() >= options.time_limit_s ||
           interrupt_request();
  };
  while (!is_over()) {
    search.step();
    if (++layout.steps % 100 == 0)
      report(progress, "lattices",
             options.steps > 0 ? 1.0 * layout.steps / options.steps : used_s() / options.time_limit_s,
             counted(search.modules(), "module"));
  }
  layout.lattices = search.lattices();
  layout.modules = static_cast<int>(search.modules());
  layout.seconds = used_s();
  return layout;
}

std::string flat_layout_text(const Polygon& given, const FlatLayout& layout, const LatticesOptions& options) {
  const Polygon polygon = normalize_polygon(given, "outline");
  nlohmann::json lattices = nlohmann::json::array(), holes = nlohmann::json::array();
  for (const auto& hole : polygon.holes) holes.push_back(ring_json(hole));
  for (const FlatLattice& l : layout.lattices) {
    nlohmann::json tiles = nlohmann::json::array();
    for (const Tile& t : l.tiles) tiles.push_back({{"i", t.i}, {"j", t.j}, {"up", t.up}});
    lattices.push_back({{"x_mm", l.placement.x_mm},
                        {"y_mm", l.placement.y_mm},
                        {"theta_rad", l.placement.theta_rad},
                        {"tiles", std::move(tiles)}});
  }
  const nlohmann::json text = {{"format", "triskin-flat-layout"},   {"version", 1},
                               {"outer", ring_json(polygon.outer)}, {"holes", std::move(holes)},
                               {"gap_mm", options.gap_mm},          {"tolerance_mm", options.tolerance_mm},
                               {"modules", layout.modules},         {"upper_bound", layout.upper_bound},
                               {"lattices", std::move(lattices)}};
  return text.dump() + "\n";
}

}  // namespace triskin::placement
