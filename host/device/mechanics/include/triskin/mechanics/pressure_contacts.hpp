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
  double noise_kpa = 0.3;          ///< The values of a taxel scatter with this deviation (docs/calibration.md).
  double model_error = 0.02;       ///< The footprint may err by this share of the group's largest value.
  double taxel_area_mm2 = 39.0;    ///< Each taxel stands for this area of skin.
  double max_link_mm = 12.0;       ///< Pressed taxels up to this far apart belong to one group.
  double contact_radius_mm = 6.0;  ///< The prior of the radius centres here; the next value is its width.
  /// With 0.3, 95 % of the contacts are expected between 3.3 and 10.8 mm. A wider prior makes the stated deviations of
  /// small contacts too small, because one or two taxels do not tell the radius (docs/calibration.md).
  double contact_radius_log_sd = 0.3;
};

/// Each pressed taxel belongs to the contact that moves it most.
struct PressureContact {
  SurfaceContact contact;
  std::vector<std::size_t> taxels;  ///< The indices refer to the lists, the strongest first; there is at least one.
};

/// Finds the contacts that explain the pressures of calibrated taxels on a curved cover, fast enough for a stream: the
/// footprint is linear in the force, so no table of the layer is needed.
///
/// Adjacent pressed taxels form a group, which is laid out in its tangent plane. For each place and radius of a grid
/// the best force has a closed form; place, radius and force are the mean of the posterior over the grid, which is
/// refined until it resolves the deviations. The prior of the radius is in the options; that of the logarithm of the
/// force is flat. If one contact does not explain the values, a second and a third are added. A group of more than 30
/// taxels, or one that round contacts do not explain (a palm, an edge), becomes one contact at its centroid whose force
/// is the sum over its taxels, which is accurate for such wide contacts.
///
/// `positions_mm`, unit `normals` (outwards) and `kpa` have one entry for each taxel that feels pressure; values that
/// are not finite are left out. `pressed` lists the indices of the pressed taxels. In the result tip_radius_mm is 0.
/// Counts may replace kPa if nothing is calibrated; forces then have that unit · 10⁻³ mm². The strongest contact
/// comes first. Throws InputError if the lists differ in length, a normal has no length, an index is beyond them or an
/// option is not positive. Cost: about 1 ms for each contact. Thread-safe.
[[nodiscard]] std::vector<PressureContact> contacts_from_pressure(
    const Footprint& footprint, std::span<const Eigen::Vector3d> positions_mm, std::span<const Eigen::Vector3d> normals,
    std::span<const double> kpa, std::span<const std::size_t> pressed, const PressureOptions& options);

}  // namespace triskin::mechanics
