// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "ray_caster.hpp"
#include "triskin/mesh/side.hpp"

namespace triskin::mesh {

/// A place on a face, and the place opposite to it on the other sheet of the wall.
struct WallSample {
  FaceIndex face = FaceIndex::none();
  Vec3 point_mm = Vec3::Zero();
  double area_mm2 = 0.0;  ///< Each sample stands for this share of its face's area.
  /// The face lies across the wall; −1 means that there is no wall here.
  FaceIndex partner = FaceIndex::none();
  double wall_mm = 0.0;
  Vec3 partner_mm = Vec3::Zero();  ///< The ray meets the partner at this point.
};

/// Returns one or more samples per face, in the order of the faces. The partner is the first face that a ray into the
/// material meets, if it lies within the thickness of a wall and faces the opposite way. Cost: one ray per sample.
[[nodiscard]] std::vector<WallSample> wall_samples(const RayCaster& part, const SideOptions& options);

/// Returns the fraction of the part's area that has a partner, 0 … 1, from some thousand faces at most. Cost: as many
/// rays.
[[nodiscard]] double walled_fraction_of_few(const RayCaster& part, const SideOptions& options);

/// Returns the fraction of each face's area, 0 … 1, that has a partner.
[[nodiscard]] std::vector<double> walled_fractions(const std::vector<WallSample>& samples, std::size_t faces);

}  // namespace triskin::mesh
