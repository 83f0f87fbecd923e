// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::skin {

/// A frame holds all taxels of a cover at one time, in lists of one length; taxel n belongs to module n / 12.
struct ContactFrame {
  std::vector<design::Vec3> position_mm, normal;
  std::vector<double> change_counts;   ///< Each value tells how far the taxel reads below rest.
  std::vector<double> counts_per_kpa;  ///< Zero marks a taxel without calibration; an empty list means none has one.
  std::vector<double> taxel_area_mm2;  ///< Each taxel of a module stands for this area; one value per module.
};

/// A contact is a place where something presses the skin, in the mesh frame, with standard deviations.
struct SkinContact {
  design::Vec3 position_mm{0, 0, 0}, normal{0, 0, 0};  ///< The position lies on the cover; the normal points outwards.
  double position_sd_mm = 0.0;             ///< The deviation holds for each of two directions along the cover.
  double force_n = 0.0, force_sd_n = 0.0;  ///< The force acts against the normal; NaN means not calibrated.
  double area_mm2 = 0.0;                   ///< The contact presses this area.
  double change_counts = 0.0;              ///< The changes of its taxels add up to this value.
  std::vector<PressedTaxel> taxels;        ///< The strongest taxel comes first; there is at least one.
};

/// Finds the contacts that explain a frame, the strongest first. `live`, recordings, the bridge, the library and Python
/// all use this function. Taxels that read at least TouchMap::kPressed_counts below rest are pressed;
/// mechanics::contacts_from_pressure describes how place, force and area follow, here with a 2 mm dielectric of
/// Poisson's ratio 0.3 and 4 mm electrodes. Forces need a calibration of every pressed taxel of a contact. Uncalibrated
/// taxels of a calibrated frame do not count. Throws InputError if lists differ in length. Cost: some ms for each
/// contact, microseconds if nothing is pressed. Thread-safe.
[[nodiscard]] std::vector<SkinContact> contacts_of(const ContactFrame& frame);

/// Finds the present contacts of a cover. An incomplete `calibration` gives no forces.
[[nodiscard]] std::vector<SkinContact> contacts_of(const TouchMap& touches, const design::Design& design,
                                                   const design::SkinCalibration& calibration);

/// The torque is about the origin of the mesh frame; all values have standard deviations.
struct NetForce {
  design::Vec3 force_n{0, 0, 0}, force_sd_n{0, 0, 0}, torque_nmm{0, 0, 0}, torque_sd_nmm{0, 0, 0};
};
/// Adds up the contacts that have a force. The taxels cannot feel tangential forces.
[[nodiscard]] NetForce net_force(std::span<const SkinContact> contacts);

}  // namespace triskin::skin
