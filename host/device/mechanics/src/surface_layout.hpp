// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "triskin/mechanics/inverse.hpp"
#include "triskin/mechanics/surface_contacts.hpp"

namespace triskin::mechanics {

/// The taxels of a curved cover and their values are in lists of one length.
struct SurfaceTaxels {
  std::span<const Eigen::Vector3d> positions, normals;
  std::span<const double> values;
};

/// Throws InputError unless the lists have one length, positions are finite and normals have the length 1.
void check(const SurfaceTaxels& taxels);

/// The indices belong to connected taxels and begin with the strongest.
using TaxelGroup = std::vector<std::size_t>;

/// Divides `pressed` into groups of connected taxels: neighbours lie within `max_link_mm` and do not face away from
/// each other. The group with the largest sum of values comes first.
[[nodiscard]] std::vector<TaxelGroup> pressed_groups(const SurfaceTaxels& taxels, TaxelGroup pressed,
                                                     double max_link_mm);

/// The layout keeps distances along the surface; besides the group it holds the finite taxels around it.
struct SurfaceLayout {
  TaxelGroup taxels;
  std::vector<Eigen::Vector2d> places_mm;
  Eigen::VectorXd values;
};
[[nodiscard]] SurfaceLayout laid_out(const SurfaceTaxels& taxels, const TaxelGroup& group);

/// Maps a contact from the plane of a layout back to the cover, to first order in its curvature.
[[nodiscard]] SurfaceContact on_cover(const SurfaceTaxels& taxels, const SurfaceLayout& layout,
                                      const ContactEstimate& found);

}  // namespace triskin::mechanics
