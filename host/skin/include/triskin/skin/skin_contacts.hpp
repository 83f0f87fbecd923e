// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::device {

/// All taxels of a cover at one time, twelve a module; lists of one length. Taxel n belongs to module n / 12.
struct ContactFrame {
  std::vector<design::Vec3> position_mm, normal;
  std::vector<double> change_counts;   ///< how far each reads below rest
  std::vector<double> counts_per_kpa;  ///< 0: not calibrated; empty: no taxel is
  std::vector<double> taxel_area_mm2;  ///< skin that a taxel of the module stands for, one a module
};

/// What presses the skin at one place, mesh frame, with standard deviations.
struct SkinContact {
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};  ///< on the cover, and outwards
  double position_sd_mm = 0.0;                         ///< along the cover, for each of its two directions
  double force_n = 0.0, force_sd_n = 0.0;              ///< against the normal; NaN without a calibration
  double area_mm2 = 0.0;                               ///< that is pressed
  double change_counts = 0.0;                          ///< sum over its taxels
  std::vector<PressedTaxel> taxels;                    ///< the strongest first; at least one
};

/// Contacts that explain a frame, the strongest first: the only place where the host makes contacts of taxels for
/// `live`, recordings, the bridge, the library and Python. Taxels of TouchMap::kPressed_counts and more below rest are
/// pressed; how place, force and area follow is said at mechanics::contacts_from_pressure, with a dielectric of 2 mm
/// with Poisson's ratio 0.3 and electrodes of 4 mm. Forces need a calibration of every pressed taxel of a contact.
/// A taxel that is not calibrated in a calibrated frame does not count. Throws InputError when lists differ in length.
/// Cost: some ms for each contact, microseconds where nothing is pressed. Thread-safe.
[[nodiscard]] std::vector<SkinContact> contacts_of(const ContactFrame& frame);

/// The contacts of a cover now. `calibration` may be incomplete; then there are no forces.
[[nodiscard]] std::vector<SkinContact> contacts_of(const TouchMap& touches, const design::Design& design,
                                                   const design::SkinCalibration& calibration);

/// Net force and its torque about the origin of the mesh frame, with standard deviations.
struct NetForce {
  design::Vec3 force_n{0, 0, 0}, force_sd_n{0, 0, 0}, torque_nmm{0, 0, 0}, torque_sd_nmm{0, 0, 0};
};
/// Sum over the contacts that have a force. Tangential forces are not felt.
[[nodiscard]] NetForce net_force(std::span<const SkinContact> contacts);

}  // namespace triskin::device
