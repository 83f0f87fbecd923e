// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

/// Files for simulators of robots (docs/export_simulators.md). Lengths in metres, the frame is that of the mesh.
namespace triskin::design {

/// Thickness of the soft dielectric over the taxels (docs/mechanics.md), mm, and radius of a taxel's electrode, mm.
inline constexpr double kDielectric_mm = 2.0, kElectrodeRadius_mm = 2.0;

/// How a model of MuJoCo reports touch.
enum class MjcfTouch {
  kTactile,  ///< one tactile sensor over all pressure taxels; needs MuJoCo 3.3.3
  kSites,    ///< one touch sensor a module; every version reads it
};

/// Model to include in another one (MJCF): a body `NAME` for the cover with a body for each module in its frame, a
/// plate that collides, and the sensors. All names begin with that of the design, letters and digits only.
/// `robot_body`: the body of the other model to which the cover is fixed, mesh frame on body frame, and with which it
/// does not collide; empty: the cover is fixed to the world. Throws InputError for a design without modules. Cost:
/// O(modules).
[[nodiscard]] std::string mjcf(const Design& design, MjcfTouch touch, const std::string& robot_body = {});

/// The pressure taxels as a list (JSON): module, taxel, link, position, normal, radius. They stand in the order of the
/// values of the tactile sensor of mjcf(). Throws as mjcf(). Cost: O(modules).
[[nodiscard]] std::string taxel_list_json(const Design& design);

/// The same as arrays of NumPy (npz): position (n × 3), normal (n × 3), radius (n), module, taxel (n) and link (n).
/// Throws as mjcf(). Cost: O(modules).
[[nodiscard]] std::string taxel_list_npz(const Design& design);

}  // namespace triskin::design
