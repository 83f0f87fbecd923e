// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/supply.hpp"

#include <algorithm>

namespace triskin::design {
namespace {

// Returns the row of each module's parent; −1 at the entry.
std::vector<int> parent_rows(const Patch& patch) {
  std::vector<int> rows;
  for (const RoutedModule& m : patch.modules) {
    const auto parent = std::ranges::find(patch.modules, m.parent, &RoutedModule::node);
    rows.push_back(parent == patch.modules.end() ? -1 : static_cast<int>(parent - patch.modules.begin()));
  }
  return rows;
}

}  // namespace

std::vector<double> supply_drops_v(const Patch& patch, double module_ma, const std::vector<double>& to_parent_ohm) {
  const std::vector<int> parent = parent_rows(patch);
  const auto up = [&](std::size_t m) { return static_cast<std::size_t>(parent[m]); };
  std::vector<double> behind_ma(parent.size(), 0.0);  // the current that passes here, that of the module included
  for (std::size_t m = 0; m < parent.size(); ++m) {
    behind_ma[m] += module_ma;
    for (std::size_t at = m; parent[at] >= 0; at = up(at)) behind_ma[up(at)] += module_ma;
  }
  std::vector<double> drops_v(parent.size(), 0.0);
  for (std::size_t m = 0; m < parent.size(); ++m) {
    drops_v[m] = to_parent_ohm.at(m) * behind_ma[m] * 1e-3;
    for (std::size_t at = m; parent[at] >= 0; at = up(at))
      drops_v[m] += to_parent_ohm[up(at)] * behind_ma[up(at)] * 1e-3;
  }
  return drops_v;
}

std::vector<double> supply_wires_ohm(const Design& design, const Patch& patch, const SupplyModel& model) {
  std::vector<double> ohm;
  for (const RoutedModule& m : patch.modules) {
    if (m.parent < 0) {
      ohm.push_back(model.cable_m * model.cable_ohm_per_m + model.plugs_ohm);
      continue;
    }
    const std::array<int, 2> ends{std::min(m.node, m.parent), std::max(m.node, m.parent)};
    const auto jumper = std::ranges::find(design.layout.jumpers, ends, &Jumper::node);
    const bool is_jumper = jumper != design.layout.jumpers.end();
    ohm.push_back(model.joint_ohm +
                  (is_jumper ? model.plugs_ohm + jumper->length_mm * 1e-3 * model.cable_ohm_per_m : 0.0));
  }
  return ohm;
}

std::vector<double> supply_voltages_v(const Design& design, const Patch& patch, const SupplyModel& model) {
  std::vector<double> volts = supply_drops_v(patch, model.module_ma, supply_wires_ohm(design, patch, model));
  for (double& v : volts) v = model.supply_v - v;
  return volts;
}

LowestSupply lowest_supply(const Design& design, const Patch& patch, const SupplyModel& model) {
  const std::vector<double> volts = supply_voltages_v(design, patch, model);
  LowestSupply lowest;
  for (std::size_t k = 0; k < volts.size(); ++k) {
    if (lowest.module < 0 || volts[k] < lowest.volts) lowest = {patch.modules[k].node, volts[k]};
  }
  return lowest;
}

}  // namespace triskin::design
