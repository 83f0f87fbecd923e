// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/connected_tiles.hpp"

#include <algorithm>

namespace triskin::placement {

std::vector<Tile> largest_component(const TileGrid& grid, const std::vector<Tile>& tiles) {
  std::vector<bool> seen(tiles.size(), false);
  std::vector<std::size_t> members, best;
  for (std::size_t first = 0; first < tiles.size(); ++first) {
    if (seen[first]) continue;
    members.assign(1, first);
    seen[first] = true;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const auto next = neighbours(grid, tiles[members[k]]);
      for (auto n = next.begin(); n != next.begin() + grid.neighbours; ++n) {
        const auto found = std::ranges::lower_bound(tiles, *n);
        if (found == tiles.end() || *found != *n) continue;
        const auto at = static_cast<std::size_t>(found - tiles.begin());
        if (seen[at]) continue;
        seen[at] = true;
        members.push_back(at);
      }
    }
    if (members.size() > best.size()) best = members;
  }
  std::ranges::sort(best);
  std::vector<Tile> component;
  for (const std::size_t k : best) component.push_back(tiles[k]);
  return component;
}

double ConnectedTiles::value(const Motion&, const std::vector<Tile>& inside) {
  return static_cast<double>(largest_component(grid_, inside).size());
}

double ConnectedTiles::bound(const CellFrame&, const std::vector<OpenTile>& certain,
                             const std::vector<OpenTile>& open) {
  certain_ = static_cast<int>(certain.size());
  tiles_.clear();
  for (const OpenTile& t : certain) tiles_.push_back(t.tile);
  for (const OpenTile& t : open) tiles_.push_back(t.tile);
  std::ranges::sort(tiles_);
  return most_ = static_cast<double>(largest_component(grid_, tiles_).size());
}

// A connected set has no more tiles than there are.
void ConnectedTiles::bound_parts(const CellFrame&, const SliceRaster& raster, PartBounds& bounds) {
  for (int x = 0; x < SliceRaster::kSteps; ++x) {
    for (int y = 0; y < SliceRaster::kSteps; ++y)
      bounds[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = raster.certain() + raster.count(x, y);
  }
}

void ConnectedTiles::bound_cubes(const PartsView&, const std::vector<PartWord>& words, CubeBounds& bounds) const {
  bounds.fill(certain_);
  for (const PartWord& word : words) {
    for (std::size_t n = 0; n < kCubes; ++n) bounds[n] += word[n % kLanesPerRow] >> (n / kLanesPerRow) & 1U;
  }
}

}  // namespace triskin::placement
