// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

constexpr std::size_t kPart_bytes = 1 << 16;

nlohmann::json rings_of(const Polygon& polygon) {
  const auto ring = [](const std::vector<Vec2>& points) {
    nlohmann::json list = nlohmann::json::array();
    for (const Vec2& p : points) list.push_back({p.x(), p.y()});
    return list;
  };
  nlohmann::json rings = nlohmann::json::array({ring(polygon.outer)});
  for (const auto& hole : polygon.holes) rings.push_back(ring(hole));
  return rings;
}

// Returns everything in the proof except the cells.
nlohmann::json claims(const Polygon& polygon, const PlacementResult& result) {
  const auto& motion = result.proof.motion;
  nlohmann::json tiles = nlohmann::json::array();
  for (const Tile& t : result.tiles) tiles.push_back({t.i, t.j, t.up ? 1 : 0});
  nlohmann::json log{{"format", "triskin-placement-proof"},
                     {"version", 1},
                     {"shape", std::string(kTileShapeNames.name(result.proof.shape))},
                     {"rings", rings_of(polygon)},
                     {"pivot", {result.proof.pivot.x(), result.proof.pivot.y()}},
                     {"pitch_mm", result.proof.pitch_mm},
                     {"tolerance_mm", result.tolerance_mm},
                     {"modules", result.modules},
                     {"upper_bound", result.upper_bound},
                     {"motion", {motion[0], motion[1], motion[2]}},
                     {"tiles", std::move(tiles)}};
  if (result.proof.corner_cut_mm > 0.0) log["corner_cut_mm"] = result.proof.corner_cut_mm;
  return log;
}

}  // namespace

ProofWriter::ProofWriter(std::function<void(std::string_view)> write)
    : write_(std::move(write)), part_("{\"cells\":[") {}

void ProofWriter::add_cell(const ProofCell& c) {
  fmt::format_to(std::back_inserter(part_), "{}[{},{},{},{},{},{}]", first_ ? "" : ",", c[0], c[1], c[2], c[3], c[4],
                 c[5]);
  first_ = false;
  if (part_.size() < kPart_bytes) return;
  write_(part_);
  part_.clear();
}

void ProofWriter::finish(const Polygon& polygon, const PlacementResult& result) {
  part_ += "],";
  part_ += claims(polygon, result).dump().substr(1);  // The cells have already opened the object.
  part_ += "\n";
  write_(part_);
  part_.clear();
}

std::string proof_text(const Polygon& polygon, const PlacementResult& result) {
  std::string text;
  ProofWriter writer([&](std::string_view part) { text += part; });
  for (const ProofCell& cell : result.proof.cells) writer.add_cell(cell);
  writer.finish(polygon, result);
  return text;
}

}  // namespace triskin::placement
