// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "search/objective_search.hpp"

namespace triskin::placement {

/// Returns the largest set of tiles that are connected by sides; of equal ones that with the first tile. `tiles` must
/// be sorted, and so is the result.
[[nodiscard]] std::vector<Tile> largest_component(const TileGrid& grid, const std::vector<Tile>& tiles);

/// Maximizes the number of tiles that are connected by sides. Its bound assumes that every open tile is inside.
class ConnectedTiles final : public Objective {
 public:
  explicit ConnectedTiles(const TileGrid& grid) : grid_(grid) {}
  double value(const Motion& motion, const std::vector<Tile>& inside) override;
  double bound(const CellFrame& cell, const std::vector<OpenTile>& certain, const std::vector<OpenTile>& open) override;
  void bound_parts(const CellFrame& slice, const SliceRaster& raster, PartBounds& bounds) override;
  void bound_cubes(const PartsView& view, const std::vector<PartWord>& words, CubeBounds& bounds) const override;
  [[nodiscard]] double most_at_middle() const override { return most_; }
  [[nodiscard]] int needed(double value) const override { return static_cast<int>(value) + 1 - certain_; }
  [[nodiscard]] double slack(double) const override { return 0.0; }

 private:
  const TileGrid& grid_;
  std::vector<Tile> tiles_;
  int certain_ = 0;
  double most_ = 0.0;
};

}  // namespace triskin::placement
