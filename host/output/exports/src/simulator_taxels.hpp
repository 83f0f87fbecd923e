// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::exports {

/// Simulators get the pressure taxels in the mesh frame, in metres.
struct SimulatorTaxel {
  int module = 0, taxel = 0;
  design::Vec3 position_m;  ///< The position is on the surface of the dielectric.
  design::Vec3 normal;
};

/// Returns all pressure taxels by module, then taxel. Throws InputError for a design without modules.
[[nodiscard]] std::vector<SimulatorTaxel> simulator_taxels(const design::Design& design);

/// Returns true for "world" and "__…__": MuJoCo has a body "world", and SDFormat reserves both.
[[nodiscard]] bool is_reserved_in_simulators(const std::string& name);
/// Returns the name of the design reduced to letters, digits and "_", as the base of other names; a reserved name ends
/// in "_skin".
[[nodiscard]] std::string simulator_name(const design::Design& design);
/// Returns the name of a module's body: that of the design and module_name().
[[nodiscard]] std::string link_name(const design::Design& design, int id);

}  // namespace triskin::exports
