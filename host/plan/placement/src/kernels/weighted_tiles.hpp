// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "search/objective_search.hpp"
#include "triskin/placement/weight_map.hpp"

namespace triskin::placement {

/// Sums the weights at the centres of the tiles. The tiles of a cell are bounded as one function of the motion, to
/// first order with the curvature of the map: near the optimum their slopes cancel, which single bounds would not see.
class WeightedTiles final : public Objective {
 public:
  WeightedTiles(const PreparedPolygon& polygon, const TileGrid& grid, const WeightMap& map)
      : polygon_(polygon), grid_(grid), map_(map) {}
  double value(const Motion& motion, const std::vector<Tile>& inside) override;
  double bound(const CellFrame& cell, const std::vector<OpenTile>& certain, const std::vector<OpenTile>& open) override;
  void bound_parts(const CellFrame& slice, const SliceRaster& raster, PartBounds& bounds) override;
  void bound_cubes(const PartsView& view, const std::vector<PartWord>& words, CubeBounds& bounds) const override;
  [[nodiscard]] double most_at_middle() const override { return middle_; }
  [[nodiscard]] int needed(double value) const override;
  [[nodiscard]] double slack(double value) const override { return kPrecision * value; }

  static constexpr double kPrecision = 1e-5;  ///< The search ends at this relative gap.

 private:
  // Motions around a centre, at which the angle has this cosine and sine; none slides farther than slide_mm from it.
  struct Range {
    std::array<double, 3> center, half;
    double cosine, sine, slide_mm;
  };
  // A function of the offset from the centre of a range, to first order.
  struct Term {
    double value = 0.0;
    std::array<double, 3> slope{};  // The slopes are along x, y and theta.
    double rest = 0.0;              // The function differs by at most this in the range.
    Term& operator+=(const Term& other);
    // Returns a bound for offsets that differ from `offset` by at most `half`.
    [[nodiscard]] double most(const std::array<double, 3>& offset, const std::array<double, 3>& half) const;
  };
  [[nodiscard]] Term term(const Range& range, const Vec2& center) const;
  void bound_block(const Range& block, const SliceRaster& raster, int first_x, int first_y, PartBounds& bounds) const;

  const PreparedPolygon& polygon_;
  const TileGrid& grid_;
  const WeightMap& map_;
  // The tiles of the last bound(): the certain ones together, and the open ones.
  Term certain_sum_;
  double certain_ = 0.0, middle_ = 0.0;
  std::vector<Term> open_terms_;
  std::vector<double> open_;
};

}  // namespace triskin::placement
