// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "triskin/mechanics/inverse.hpp"
#include "triskin/mechanics/surface_contacts.hpp"

namespace triskin::mechanics {

/// Taxels of a curved cover and their values; lists of one length.
struct SurfaceTaxels {
  std::span<const Eigen::Vector3d> positions, normals;
  std::span<const double> values;
};

/// Throws InputError unless the lists have one length, positions are finite and normals have the length 1.
void check(const SurfaceTaxels& taxels);

/// Indices of taxels that hang together, the strongest first.
using TaxelGroup = std::vector<std::size_t>;

/// The taxels of `pressed` that hang together: neighbours lie within `max_link_mm` and do not face away from each
/// other. The group with the largest sum of values comes first.
[[nodiscard]] std::vector<TaxelGroup> pressed_groups(const SurfaceTaxels& taxels, TaxelGroup pressed,
                                                     double max_link_mm);

/// A group and the finite taxels about it, laid out in the tangent plane with distances along the surface kept.
struct SurfaceLayout {
  TaxelGroup taxels;
  std::vector<Eigen::Vector2d> places_mm;
  Eigen::VectorXd values;
};
[[nodiscard]] SurfaceLayout laid_out(const SurfaceTaxels& taxels, const TaxelGroup& group);

/// A contact in the plane of a layout, back on the cover to first order in its curvature.
[[nodiscard]] SurfaceContact on_cover(const SurfaceTaxels& taxels, const SurfaceLayout& layout,
                                      const ContactEstimate& found);

}  // namespace triskin::mechanics
