// SPDX-License-Identifier: GPL-3.0-or-later
#include "electrical.hpp"

#include <algorithm>

#include "local_graph.hpp"

namespace triskin::routing {
namespace {

// Gives the fastest bus at which a rise time is allowed (I²C-bus specification UM10204, table 10).
struct Mode {
  double bus_hz, rise_ns;
};
constexpr Mode kFast{400e3, 300.0}, kStandard{100e3, 1000.0};
constexpr double kRise = 0.8473;  // ln(0.7 / 0.3) relates RC to the rise from 30 to 70 %.

double allowed_rise_ns(double bus_hz) {
  return bus_hz > kStandard.bus_hz ? kFast.rise_ns : kStandard.rise_ns;
}

}  // namespace

LineElectrical electrical_state(const ElectricalModel& model, const LineLoad& load) {
  LineElectrical e;
  e.modules = load.modules;
  e.capacitance_pf = model.cable_pf_per_m * (load.cable_m + load.jumper_m) + model.joint_pf * load.joints +
                     model.jumper_pf * load.jumpers + model.pin_pf * load.modules + model.switch_pf * load.passed;
  e.pull_up_min_ohm = (model.supply_v - model.low_level_v) / (model.sink_ma * 1e-3);
  e.pull_up_max_ohm = e.capacitance_pf > 0 ? allowed_rise_ns(model.bus_hz) * 1e3 / (kRise * e.capacitance_pf) : 1e9;
  e.rise_time_ns = kRise * e.pull_up_min_ohm * e.capacitance_pf * 1e-3;
  e.max_bus_hz = e.rise_time_ns <= kFast.rise_ns       ? kFast.bus_hz
                 : e.rise_time_ns <= kStandard.rise_ns ? kStandard.bus_hz
                                                       : 0.0;
  return e;
}

bool violates(const ElectricalModel& model, const LineElectrical& line) {
  return line.modules > 0 && line.max_bus_hz < model.bus_hz;
}

std::vector<LineLoad> line_loads(const ElectricalModel& model, const Numbers& parent, const Numbers& line, int lines,
                                 double cable_m, const std::vector<double>& jumper_m) {
  const int n = static_cast<int>(parent.size());
  Table<int, unsigned> below(parent.size(), 0);  // Each bit is a line that is used at or below the node.
  for (std::size_t v = parent.size(); v-- > 0;) {
    below[v] |= 1U << line[v];
    if (parent[v] >= 0) below[parent[v]] |= below[v];
  }
  Table<int, LineLoad> loads(at(lines));
  for (int l = 0; l < lines; ++l) {
    LineLoad& load = loads[l];
    load.cable_m = cable_m;
    load.modules = static_cast<int>(std::ranges::count(line, l));
    int reached = n;
    if (!model.all_lines_on_all_joints)
      reached = static_cast<int>(std::ranges::count_if(below, [l](unsigned b) { return (b >> l & 1U) != 0; }));
    load.joints = std::max(0, reached - 1);
    load.passed = reached - load.modules;
    for (std::size_t v = 0; v < jumper_m.size(); ++v) {
      if (jumper_m[v] < 0.0 || (!model.all_lines_on_all_joints && (below[v] >> l & 1U) == 0)) continue;
      ++load.jumpers;
      load.jumper_m += jumper_m[v];
    }
  }
  return loads;
}

}  // namespace triskin::routing
