// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "triskin/mechanics/contact_table.hpp"

namespace triskin::mechanics {

struct SurfaceOptions {
  double noise_dc_over_c = 0.01;  ///< The values of the taxels have this standard deviation.
  double disc_diameter_mm = 4.0;  ///< The electrodes of the taxels have this diameter.
  /// The limit holds for the whole cover; the groups of taxels that are pressed most come first.
  int max_contacts = 10;
  double max_link_mm = 12.0;  ///< Pressed taxels that are no farther apart belong to one group.
};

/// A contact on a curved cover, with the standard deviations of its values.
struct SurfaceContact {
  /// The position lies on the cover, to first order in its curvature.
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  /// The normal of the cover points outwards; the force acts against it.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double position_sd_mm = 0.0;  ///< The deviation is measured along the cover, as the root mean square of both axes.
  double force_n = 0.0, force_sd_n = 0.0;
  double area_mm2 = 0.0;  ///< The layer is pressed over this area.
  double tip_radius_mm = 0.0;
  /// The group has this many pressed taxels; fewer than three hardly determine place and force.
  int pressed_taxels = 0;
};

/// Finds contacts that explain the values of the taxels of a cover, fast enough for a stream: adjacent pressed taxels
/// form a group; each group is laid out in its tangent plane with distances along the surface kept (exact on a
/// cylinder), and one to three contacts are fitted there with the table as the model. The fit starts at the strongest
/// taxel only and stops when the remainder looks like noise; find_contacts() spends more on one observation.
///
/// `positions_mm`, unit `normals` (outwards) and `dc_over_c` have one entry per taxel that feels pressure; values that
/// are not finite are left out. Taxels below four deviations of the noise count as not pressed. Throws InputError when
/// the lists differ in length, a normal has no length, or an option is out of range. The strongest contact comes first.
/// Cost: some 20 ms per group on one core, bounded by max_contacts; without a pressed taxel some microseconds.
/// Thread-safe. The curvature of the layer itself is neglected: an error of the order thickness over radius.
[[nodiscard]] std::vector<SurfaceContact> contacts_from_taxels(const ContactTable& table,
                                                               std::span<const Eigen::Vector3d> positions_mm,
                                                               std::span<const Eigen::Vector3d> normals,
                                                               std::span<const double> dc_over_c,
                                                               const SurfaceOptions& options);

/// A wrench has force and torque on a cover, with standard deviations of each component.
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero(), force_sd_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_nmm = Eigen::Vector3d::Zero(), torque_sd_nmm = Eigen::Vector3d::Zero();
};

/// Returns the net force of `contacts` and their torque about a point, in the frame of the contacts. Errors of
/// different contacts are assumed independent; tangential forces cannot be felt and are not included.
[[nodiscard]] Wrench net_wrench(std::span<const SurfaceContact> contacts, const Eigen::Vector3d& about_mm);

}  // namespace triskin::mechanics
