// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator_taxels.hpp"

#include <fmt/format.h>

#include "metres.hpp"
#include "module_names.hpp"
#include "triskin/base/ascii_name.hpp"
#include "triskin/base/error.hpp"
#include "triskin/exports/simulators.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::exports {

std::vector<SimulatorTaxel> simulator_taxels(const design::Design& design) {
  if (design.layout.modules.empty())
    throw InputError(fmt::format("{}: the design has no modules, so there is nothing to simulate", design.name));
  const auto wiring = design::wiring_of(design);
  std::vector<SimulatorTaxel> list;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const auto taxels = design::taxels_of(design.layout.modules[m], wiring[m].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      if (!layout::measures_pressure(t)) continue;
      const design::Vec3 surface_mm = taxels[t].position_mm + kDielectric_mm * taxels[t].normal;
      list.push_back({static_cast<int>(m), static_cast<int>(t), surface_mm * kMetres_per_mm, taxels[t].normal});
    }
  }
  return list;
}

bool is_reserved_in_simulators(const std::string& name) {
  return name == "world" || (name.size() >= 4 && name.starts_with("__") && name.ends_with("__"));
}

std::string simulator_name(const design::Design& design) {
  std::string name = ascii_name(design.name, "", "skin");
  return is_reserved_in_simulators(name) ? name + "_skin" : name;
}

std::string link_name(const design::Design& design, int id) {
  return simulator_name(design) + "_" + module_name(design, id);
}

}  // namespace triskin::exports
