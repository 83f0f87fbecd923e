// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "triskin/mechanics/footprint.hpp"
#include "triskin/mechanics/surface_contacts.hpp"

namespace triskin::mechanics {

struct PressureOptions {
  double noise_kpa = 0.02;         ///< standard deviation of a taxel's value
  double model_error = 0.02;       ///< what the footprint may err by, as a share of the group's largest value
  double taxel_area_mm2 = 39.0;    ///< skin that a taxel stands for
  double max_link_mm = 12.0;       ///< pressed taxels no farther apart belong to one group
  double contact_radius_mm = 6.0;  ///< the radius that contacts have, give or take the next factor
  double contact_radius_log_sd = 0.4;
};

/// A contact of contacts_from_pressure() and the pressed taxels that it moves most.
struct PressureContact {
  SurfaceContact contact;
  std::vector<std::size_t> taxels;  ///< indices into the lists, the strongest first; at least one
};

/// Contacts that explain the pressures of calibrated taxels on a curved cover, for a stream: no table of the layer is
/// needed, since the model is the footprint, in which the force is linear.
///
/// Pressed taxels side by side form a group, laid out in its tangent plane. For each place and radius of a grid the
/// force that explains the values best follows at once; place, radius and force are then the mean of the posterior over
/// the grid, which is made finer about it until it resolves the deviations. Priors: the radius as the options say, the
/// logarithm of the force even. What one contact leaves unexplained becomes a second and a third. A group of more than
/// 30 taxels, or one that round contacts do not explain (a palm, an edge), is one contact at its centroid with the sum
/// of its taxels as its force; for such wide ones the sum is right.
///
/// `positions_mm`, unit `normals` (outwards) and `kpa` have one entry for each taxel that feels pressure; values that
/// are not finite are left out. `pressed`: indices of the taxels that count as pressed. Of the result, tip_radius_mm
/// is 0. Counts may stand in for kPa if nothing is calibrated; then forces are in that unit · 10⁻³ mm². The
/// strongest contact comes first. Throws InputError when the lists differ in length, a normal has no length, an index
/// is beyond them or an option is not positive. Cost: about 1 ms a contact. Thread-safe.
[[nodiscard]] std::vector<PressureContact> contacts_from_pressure(
    const Footprint& footprint, std::span<const Eigen::Vector3d> positions_mm, std::span<const Eigen::Vector3d> normals,
    std::span<const double> kpa, std::span<const std::size_t> pressed, const PressureOptions& options);

}  // namespace triskin::mechanics
