// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// A taxel that measures pressure, in the mesh frame, metres.
struct SimulatorTaxel {
  int module = 0, taxel = 0;
  Vec3 position_m;  ///< on the surface of the dielectric
  Vec3 normal;
};

/// All of them by module, then taxel. Throws InputError for a design without modules.
[[nodiscard]] std::vector<SimulatorTaxel> simulator_taxels(const Design& design);

/// Name of the design of which other names are made: letters, digits and "_".
[[nodiscard]] std::string simulator_name(const Design& design);
/// Name of the body of a module.
[[nodiscard]] std::string link_name(const std::string& design_name, int module);

}  // namespace triskin::design
