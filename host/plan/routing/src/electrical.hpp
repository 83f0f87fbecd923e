// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

/// Lists what loads one line of a patch.
struct LineLoad {
  int modules = 0;  ///< Each module adds a converter to the line.
  int joints = 0;   ///< These joints carry the line.
  int passed = 0;   ///< The line passes these modules without reading them.
  double cable_m = 0.0;
  int jumpers = 0;        ///< These jumpers are among the joints.
  double jumper_m = 0.0;  ///< All these jumpers together have this length.
};
/// Computes C = cable + joints * C_joint + jumpers * C_plugs + cable of jumpers + modules * C_pin + passed * C_switch,
/// and the rise time 0.8473·R·C (30 … 70 %, I²C UM10204).
[[nodiscard]] LineElectrical electrical_state(const ElectricalModel& model, const LineLoad& load);
/// Returns true if the required bus speed is above the one that the line carries safely.
[[nodiscard]] bool violates(const ElectricalModel& model, const LineElectrical& line);

/// Returns the loads of every line of a tree in parents-first order: parent[0] = -1, line[k] of node k. jumper_m[k] is
/// the length of the jumper from node k to its parent, -1 if a joint of the lattice leads there; an empty list means
/// that there is no jumper.
[[nodiscard]] std::vector<LineLoad> line_loads(const ElectricalModel& model, const Numbers& parent, const Numbers& line,
                                               int lines, double cable_m, const std::vector<double>& jumper_m = {});

}  // namespace triskin::routing
