// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

/// Writes files for robot simulators (docs/exports.md). Lengths are in metres, in the frame of the mesh.
namespace triskin::exports {

/// The soft dielectric over the taxels has this thickness (docs/mechanics.md), and a taxel's electrode has this radius,
/// both in mm.
inline constexpr double kDielectric_mm = 2.0, kElectrodeRadius_mm = 2.0;

/// A MuJoCo model can report touch in these ways.
enum class MjcfTouch {
  kTactile,  ///< One tactile sensor covers all pressure taxels; this needs MuJoCo 3.3.3.
  kSites,    ///< Each module has one touch sensor; every version of MuJoCo reads it.
};

/// Writes a model to include in another one (MJCF): a body `NAME` for the cover with a body for each module in its
/// frame, a plate that collides, and the sensors. All names begin with that of the design, with letters and digits
/// only. `robot_body` is the body of the other model to which the cover is fixed, mesh frame on body frame, and with
/// which it does not collide; if it is empty, the cover is fixed to the world. Throws InputError for a design without
/// modules. Cost: O(modules).
[[nodiscard]] std::string mjcf(const design::Design& design, MjcfTouch touch, const std::string& robot_body = {});

/// Lists the pressure taxels as JSON: module, taxel, link, position, normal, radius, in the order of the values of
/// mjcf()'s tactile sensor. Throws as mjcf(). Cost: O(modules).
[[nodiscard]] std::string taxel_list_json(const design::Design& design);

/// Writes the same list as NumPy arrays (npz): position (n × 3), normal (n × 3), radius (n), module, taxel (n) and
/// link (n). Throws as mjcf(). Cost: O(modules).
[[nodiscard]] std::string taxel_list_npz(const design::Design& design);

}  // namespace triskin::exports
