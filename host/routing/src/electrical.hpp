// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/routing/routing.hpp"

namespace triskin::geometry {

/// Load of one line of a patch.
struct LineLoad {
  int modules = 0;  ///< It counts the converters on the line.
  int joints = 0;   ///< It counts the joints that carry the line.
  int passed = 0;   ///< It counts modules that the line passes without being read there.
  double cable_m = 0.0;
  int jumpers = 0;        ///< It counts the jumpers among the joints.
  double jumper_m = 0.0;  ///< It is the total length of these jumpers.
};
/// C = cable + joints * C_joint + jumpers * C_plugs + cable of jumpers + modules * C_pin + passed * C_switch; rise time
/// 0.8473·R·C (30 … 70 %, I²C UM10204).
[[nodiscard]] LineElectrical electrical_state(const ElectricalModel& model, const LineLoad& load);
/// The required bus speed is above what the line carries safely.
[[nodiscard]] bool violates(const ElectricalModel& model, const LineElectrical& line);

/// Loads of every line of a tree in parents-first order: parent[0] = -1, line[k] of node k. jumper_m[k]: length of the
/// jumper from node k to its parent, -1 where a joint of the lattice leads there; empty: there is no jumper.
[[nodiscard]] std::vector<LineLoad> line_loads(const ElectricalModel& model, const std::vector<int>& parent,
                                               const std::vector<int>& line, int lines, double cable_m,
                                               const std::vector<double>& jumper_m = {});

}  // namespace triskin::geometry
