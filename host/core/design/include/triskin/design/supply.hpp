// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// What the wires of a patch cost its supply. docs/routing.md has the sources; resistances are those of supply and
/// ground together.
struct SupplyModel {
  double supply_v = 3.2;  ///< at the controller: 3.3 V − 3 %
  double module_ma = 1.0;
  double cable_m = 0.5;
  double cable_ohm_per_m = 0.98;
  double plugs_ohm = 0.12;  ///< the two plugs of a cable or jumper
  double joint_ohm = 0.23;  ///< the rings of a module from its input port to another one
  double converter_v = 2.6, margin_v = 0.15;
  [[nodiscard]] double needed_v() const { return converter_v + margin_v; }
};

/// Returns the voltage that is lost between the controller and each module, in the order of patch.modules.
/// `to_parent_ohm` has the resistance between each module and its parent, that of the entry leads to the controller. A
/// wire carries the current of all modules behind it. Cost: modules times depth of the tree.
[[nodiscard]] std::vector<double> supply_drops_v(const Patch& patch, double module_ma,
                                                 const std::vector<double>& to_parent_ohm);

/// Returns those resistances by the model; a joint that is a jumper has its plugs and its length of cable besides.
[[nodiscard]] std::vector<double> supply_wires_ohm(const Design& design, const Patch& patch, const SupplyModel& model);

/// Returns the voltage between supply and ground at each module, in the order of patch.modules.
[[nodiscard]] std::vector<double> supply_voltages_v(const Design& design, const Patch& patch,
                                                    const SupplyModel& model = {});

/// The module of a patch with the lowest supply: the last one of some branch.
struct LowestSupply {
  int module = -1;  ///< −1 in a patch without modules
  double volts = 0.0;
};
[[nodiscard]] LowestSupply lowest_supply(const Design& design, const Patch& patch, const SupplyModel& model = {});

}  // namespace triskin::design
