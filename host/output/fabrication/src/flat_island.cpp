// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/fabrication/flat_island.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "ring.hpp"
#include "triskin/base/ascii_name.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::fabrication {

using design::Tile;
using design::Vec2;

namespace {

using GridVertex = std::array<int, 2>;
// The end of a corner cut lies on the lattice side from `from` towards `to`, one cut away from `from`.
using CutEnd = std::array<GridVertex, 2>;

Vec2 place_of(const FlatIsland& island, const CutEnd& end) {
  const Vec2 from = design::grid_point(end[0][0], end[0][1]), to = design::grid_point(end[1][0], end[1][1]);
  return island.shift_mm + from + island.corner_cut_mm / design::kSide_mm * (to - from);
}

// Returns the edges of the contour, each from one end of a cut to the next. Material lies on the left.
std::map<CutEnd, CutEnd> contour_edges(const design::Design& design, const sheet::Sides& sides,
                                       const std::vector<int>& modules) {
  std::map<CutEnd, CutEnd> next;
  for (const int id : modules) {
    const Tile& tile = design.layout.modules[at(id)].tile;
    for (int s = 0; s < 3; ++s) {
      const GridVertex a = design::tile_corner_index(tile, s), b = design::tile_corner_index(tile, (s + 1) % 3);
      const GridVertex before = design::tile_corner_index(tile, (s + 2) % 3);
      next[{a, before}] = {a, b};
      if (sides.of[at(id)][at(s)].kind == sheet::SideKind::kOutline) next[{a, b}] = {b, a};
    }
  }
  return next;
}

void trace_contour(std::map<CutEnd, CutEnd> next, FlatIsland& island) {
  while (!next.empty()) {
    const CutEnd start = next.begin()->first;
    std::vector<Vec2> ring;
    CutEnd at = start;
    do {
      ring.push_back(place_of(island, at));
      const auto edge = next.find(at);
      at = edge->second;
      next.erase(edge);
    } while (at != start);
    if (area_within(ring) > 0.0) {
      island.outline_mm = std::move(ring);
    } else {
      island.holes_mm.push_back(std::move(ring));
    }
  }
}

void add_lines(const design::Design& design, const sheet::Sides& sides, FlatIsland& island) {
  for (const int id : island.modules) {
    const Tile& tile = design.layout.modules[at(id)].tile;
    for (int s = 0; s < 3; ++s) {
      const sheet::Side& side = sides.of[at(id)][at(s)];
      if (side.other < id) continue;  // A pair is drawn from its lower module; an outline has no other.
      const GridVertex a = design::tile_corner_index(tile, s), b = design::tile_corner_index(tile, (s + 1) % 3);
      const Vec2 from = place_of(island, {a, b}), to = place_of(island, {b, a});
      if (side.kind == sheet::SideKind::kSlit) {
        island.slits.push_back({from, to, {id, side.other}});
      } else {
        island.folds.push_back({from, to, side.fold_rad, {id, side.other}, side.kind == sheet::SideKind::kKept});
      }
    }
  }
}

Vec2 center_on(const FlatIsland& island, const Tile& tile) {
  return (corner_on(island, tile, 0) + corner_on(island, tile, 1) + corner_on(island, tile, 2)) / 3.0;
}

void mark_side(const FlatIsland& island, const Tile& tile, int side, std::string text, std::vector<Mark>& marks) {
  const Vec2 a = corner_on(island, tile, side), b = corner_on(island, tile, (side + 1) % 3);
  const Vec2 along = b - a, middle = (a + b) / 2.0;
  const Vec2 inward = (center_on(island, tile) - middle).normalized();
  constexpr double kFromSide_mm = 2.5;
  marks.push_back({middle + kFromSide_mm * inward, std::move(text), 1.5, std::atan2(along.y(), along.x())});
}

void add_marks(const design::Design& design, const sheet::Sides& sides, FlatIsland& island) {
  const auto wiring = design::wiring_of(design);
  for (const int id : island.modules) {
    const Tile& tile = design.layout.modules[at(id)].tile;
    const auto& wired = wiring[at(id)];
    island.marks.push_back({center_on(island, tile), fmt::format("{}", design::number_of(design, id)), 3.0, 0.0});
    for (int s = 0; s < 3; ++s) {
      const sheet::Side& side = sides.of[at(id)][at(s)];
      std::string text = wired.patch >= 0 && wired.routed.rotation == s ? "A" : "";
      if (side.cable) text += fmt::format(" C{}", wired.patch);
      if (side.jumper >= 0) text += " " + design::jumper_name(design, design.layout.jumpers[at(side.jumper)]);
      if (!text.empty()) mark_side(island, tile, s, text, island.marks);
    }
  }
  constexpr double kBelow_mm = 5.0;
  island.marks.push_back({{design::kSide_mm, -kBelow_mm}, island.part_number, 3.0, 0.0});
}

Vec2 low_corner_of(const design::Design& design, const std::vector<int>& modules) {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::max());
  for (const int id : modules) {
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = design::tile_corner_index(design.layout.modules[at(id)].tile, k);
      low = low.cwiseMin(design::grid_point(i, j));
    }
  }
  return low;
}

}  // namespace

Vec2 corner_on(const FlatIsland& island, const Tile& tile, int corner) {
  const auto [i, j] = design::tile_corner_index(tile, corner);
  return island.shift_mm + design::grid_point(i, j);
}

double text_angle_rad(const Fold& fold) {
  const Vec2 along = fold.to_mm - fold.from_mm;
  return along.x() < 0.0 ? std::atan2(-along.y(), -along.x()) : std::atan2(along.y(), along.x());
}

std::string plain_name(const std::string& text) {
  return ascii_name(text, ".-", "design");
}

std::vector<FlatIsland> flat_islands(const design::Design& design, const sheet::Sides& sides, double relief_mm) {
  if (!(relief_mm > 0.0 && relief_mm <= kMaxCornerRelief_mm))
    throw InputError(fmt::format("a corner relief of {} mm is out of range: above 0, at most {} mm", relief_mm,
                                 kMaxCornerRelief_mm));
  if (design.layout.modules.empty()) throw InputError("the design has no modules; there is nothing to fabricate");
  std::map<int, std::vector<int>> members;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    members[design.layout.modules[k].island].push_back(static_cast<int>(k));
  std::vector<FlatIsland> islands;
  for (const auto& [number, modules] : members) {
    FlatIsland island;
    island.island = number;
    island.part_number = fmt::format("{}-I{}-{}", plain_name(design.name), number,
                                     fmt::format("{:016x}", design.design_id).substr(0, 8));
    island.modules = modules;
    island.corner_cut_mm = std::max(design.layout.corner_cut_mm, relief_mm);
    island.shift_mm = -low_corner_of(design, modules);
    trace_contour(contour_edges(design, sides, modules), island);
    add_lines(design, sides, island);
    add_marks(design, sides, island);
    islands.push_back(std::move(island));
  }
  return islands;
}

}  // namespace triskin::fabrication
