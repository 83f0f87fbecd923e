// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper/pierced.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::placement::paper {
namespace {

struct Position {
  Tile tile;           // The tile that contains the point.
  double depth = 0.0;  // The depth to its nearest side is in rows.
};

Position locate(double u, double v) {
  const double i = std::floor(u), j = std::floor(v), in_u = u - i, in_v = v - j, past = in_u + in_v - 1.0;
  const Tile tile{static_cast<int>(i), static_cast<int>(j), past < 0.0};
  if (tile.up) return {tile, std::min({in_u, in_v, -past})};
  return {tile, std::min({1.0 - in_u, 1.0 - in_v, past})};
}

// Finds the module that contains a ring of the polygon, sides included, if there is one: that of its mean vertex.
bool fills_one_module(const GridFrame& frame, std::size_t first, std::size_t last, Tile& tile) {
  double u = 0.0, v = 0.0;
  for (std::size_t k = first; k < last; ++k) {
    u += frame.u()[k];
    v += frame.v()[k];
  }
  const auto n = static_cast<double>(last - first);
  tile = locate(u / n, v / n).tile;
  for (std::size_t k = first; k < last; ++k) {
    const double in_u = frame.u()[k] - tile.i, in_v = frame.v()[k] - tile.j, past = in_u + in_v - 1.0;
    const double depth = tile.up ? std::min({in_u, in_v, -past}) : std::min({1.0 - in_u, 1.0 - in_v, past});
    if (depth < -frame.touch_across()) return false;
  }
  return true;
}

}  // namespace

void reject_pierced(const GridFrame& frame, SideMarks& marks) {
  for (std::size_t k = 0; k < frame.u().size(); ++k) {
    const Position at = locate(frame.u()[k], frame.v()[k]);
    if (at.depth > frame.touch_across()) marks.reject(at.tile);
  }
  for (std::size_t ring = 1; ring < frame.rings(); ++ring) {
    Tile tile;
    if (fills_one_module(frame, frame.ring_begin(ring), frame.ring_begin(ring + 1), tile)) marks.reject(tile);
  }
}

}  // namespace triskin::placement::paper
