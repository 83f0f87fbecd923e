// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <utility>
#include <vector>

#include "canonical.hpp"
#include "net.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {

/// The regions of a cover in the frame of the search. Immutable, so the chains share it.
class CopiedRegions {
 public:
  /// `regions` may be null: every place is then worth the same. Refers to both.
  CopiedRegions(const mesh::SurfaceRegions* regions, const CanonicalCopy& copy);

  [[nodiscard]] bool has_weights() const { return regions_ != nullptr && regions_->has_weights(); }
  [[nodiscard]] double weight_at(const Vec3& center) const { return regions_->weight_at(copy_.to_original(center)); }
  [[nodiscard]] const std::vector<Vec3>& free_points() const { return free_points_; }
  /// Each place costs `share` · kUncoveredCost modules when it is not covered.
  [[nodiscard]] const std::vector<mesh::SurfaceRegions::MustCover>& must_cover() const { return must_cover_; }

 private:
  const mesh::SurfaceRegions* regions_;
  const CanonicalCopy& copy_;
  std::vector<Vec3> free_points_;
  std::vector<mesh::SurfaceRegions::MustCover> must_cover_;
};

/// Values the modules of a net: their number without regions, else the sum of their weights less the cost of uncovered
/// places that must be covered. Remembers the weight of each module until it moves, so each thread needs its own
/// object. Cost: nothing without regions; a few ns per module, and about 0.3 µs per place that must be covered.
class PlaceValue {
 public:
  explicit PlaceValue(const CopiedRegions& regions) : regions_(regions) {}
  [[nodiscard]] double operator()(const LatticeMesh& net);
  /// Returns true if a module lies near enough to a place that must be covered.
  [[nodiscard]] static bool covered(const LatticeMesh& net, const mesh::SurfaceRegions::MustCover& place);

 private:
  struct Known {
    Vec3 center = Vec3::Constant(1e300);
    double weight = 0.0;
  };
  const CopiedRegions& regions_;
  std::vector<Known> known_;
};

}  // namespace triskin::lattice
