// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "triskin/placement/placement.hpp"

namespace triskin::geometry {

std::string proof_text(const Polygon& polygon, const PlacementResult& result) {
  using nlohmann::json;
  const auto ring = [](const std::vector<Vec2>& points) {
    json list = json::array();
    for (const Vec2& p : points) list.push_back({p.x(), p.y()});
    return list;
  };
  json rings = json::array({ring(polygon.outer)});
  for (const auto& hole : polygon.holes) rings.push_back(ring(hole));
  json tiles = json::array(), cells = json::array();
  for (const Tile& t : result.tiles) tiles.push_back({t.i, t.j, t.up ? 1 : 0});
  for (const auto& c : result.proof.cells) cells.push_back(c);
  const auto& motion = result.proof.motion;
  json log{{"format", "triskin-placement-proof"},
           {"version", 1},
           {"shape", std::string(kTileShapeNames.name(result.proof.shape))},
           {"rings", std::move(rings)},
           {"pivot", {result.proof.pivot.x(), result.proof.pivot.y()}},
           {"pitch_mm", result.proof.pitch_mm},
           {"tolerance_mm", result.tolerance_mm},
           {"modules", result.modules},
           {"upper_bound", result.upper_bound},
           {"motion", {motion[0], motion[1], motion[2]}},
           {"tiles", std::move(tiles)},
           {"cells", std::move(cells)}};
  if (result.proof.corner_cut_mm > 0.0) log["corner_cut_mm"] = result.proof.corner_cut_mm;
  return log.dump() + "\n";
}

}  // namespace triskin::geometry
