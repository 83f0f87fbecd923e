// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <utility>
#include <vector>

#include "triskin/lattice/canonical.hpp"
#include "triskin/lattice/net.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::geometry::surface_lattice {

/// Regions of a cover in the frame of the search. Immutable: shared by the chains.
class CopiedRegions {
 public:
  /// `regions` may be null: every place is worth the same. Refers to both.
  CopiedRegions(const SurfaceRegions* regions, const CanonicalCopy& copy);

  [[nodiscard]] bool has_weights() const { return regions_ != nullptr && regions_->has_weights(); }
  [[nodiscard]] double weight_at(const Vec3& center) const { return regions_->weight_at(copy_.to_original(center)); }
  [[nodiscard]] const std::vector<Vec3>& free_points() const { return free_points_; }
  /// Each costs `share` · kUncoveredCost modules when it is not covered.
  [[nodiscard]] const std::vector<SurfaceRegions::MustCover>& must_cover() const { return must_cover_; }

 private:
  const SurfaceRegions* regions_;
  const CanonicalCopy& copy_;
  std::vector<Vec3> free_points_;
  std::vector<SurfaceRegions::MustCover> must_cover_;
};

/// Worth of the modules of a net: their number where there are no regions, else Σ of their weights less what is not
/// covered and must be. Remembers the weight of each module until it moves; one object a thread. Cost: nothing without
/// regions; a few ns a module, and about 0.3 µs a place that must be covered.
class PlaceValue {
 public:
  explicit PlaceValue(const CopiedRegions& regions) : regions_(regions) {}
  [[nodiscard]] double operator()(const LatticeMesh& net);
  /// True if a module lies near enough to a place that must be covered.
  [[nodiscard]] static bool covered(const LatticeMesh& net, const SurfaceRegions::MustCover& place);

 private:
  struct Known {
    Vec3 center = Vec3::Constant(1e300);
    double weight = 0.0;
  };
  const CopiedRegions& regions_;
  std::vector<Known> known_;  // Indexed by triangle.
};

}  // namespace triskin::geometry::surface_lattice
