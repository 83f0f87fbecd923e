// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/geometry/lattice.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

/// Modules and joints to be wired. Node v has neighbour[s] across tile side s (or -1, symmetric).
/// border[s]: an entry cable can reach side s (always false where a neighbour is joined).
struct ModuleGraph {
  struct Node {
    std::array<int, 3> neighbour{-1, -1, -1};
    std::array<bool, 3> border{true, true, true};
    int island = 0;
    std::array<double, 3> center_mm{};  ///< for cable lengths; zeros when unknown
  };
  std::vector<Node> nodes;
};

/// One module in a patch. `rotation` r: the module is turned so that its input port (port 0 = A) lies at
/// tile side r; port p lies at tile side (p + r) % 3. The input port faces the parent; that of the entry
/// module faces the cable.
struct RoutedModule {
  int node = -1;
  int parent = -1;   ///< node, -1 for the entry module
  int rotation = 0;  ///< 0..2
  int line = 0;      ///< 0..3
  int address = 0;   ///< 0..3, CDC address 0x2C + address
  int depth = 0;     ///< 0 for the entry module
};

/// What one failure costs, in modules of the patch that are no longer read (the failed one included).
struct FailureLoss {
  int node = -1;           ///< failed module; for a joint: the child end in the tree, or either end
  int other_node = -1;     ///< -1: module failure; else the other end of the failed joint
  int lost_strapped = 0;   ///< without rerouting: the subtree
  int lost_rerouted = 0;   ///< switched modules, over the surviving joints of the patch from the one entry
  int lost_backed_up = 0;  ///< also with the second entry and with adoption by neighbouring patches
  std::vector<std::array<int, 2>>
      backup_tree;  ///< (child, parent) pairs that differ from the normal tree; parent -1: the second entry
  std::vector<std::array<int, 2>> adopted;  ///< (child, parent) where the child is read by another patch; parents first
};

/// Electrical state of one line: its capacitance and what follows from it (docs/routing.md has formulas and sources).
struct LineElectrical {
  int modules = 0;
  double capacitance_pf = 0.0;
  double pull_up_min_ohm = 0.0;  ///< sink current
  double pull_up_max_ohm = 0.0;  ///< rise time at the required bus speed
  double rise_time_ns = 0.0;     ///< with the smallest pull-up
  double max_bus_hz = 0.0;       ///< highest safe standard speed; 0 when none is
};

struct Patch {
  int entry = -1;                              ///< node; an entry has tree degree ≤ 2
  std::vector<RoutedModule> modules;           ///< ≤ 16, parents before children
  std::vector<std::array<int, 2>> cut_joints;  ///< joints inside the patch that carry no signal
  int line_hops = 0;                           ///< Σ over tree edges of the lines that are used below the edge
  int max_depth = 0;
  std::vector<FailureLoss> failures;
  bool border_entry = false;         ///< the entry's cable side is reached from outside
  int second_entry = -1;             ///< node where a second connector saves most modules; -1: none saves any
  int second_entry_side = -1;        ///< carries no joint of the patch: on the border, or at the seam to another patch
  bool second_entry_border = false;  ///< false: its cable passes through the skin
  int second_entry_saves = 0;        ///< modules, summed over all single failures
  std::vector<int> articulation;     ///< modules whose failure parts others of the patch from its joints
  std::vector<std::array<int, 2>> bridges;  ///< joints whose failure does
  std::vector<LineElectrical> lines;        ///< one per line
  int electrical_violations = 0;            ///< lines too heavy for the required bus speed
};

/// Constants of the electrical rule; sources in docs/routing.md.
struct ElectricalModel {
  double supply_v = 3.3;
  double low_level_v = 0.4;      ///< I²C V_OL
  double sink_ma = 3.0;          ///< I²C I_OL
  double bus_hz = 400e3;         ///< required speed
  double cable_pf_per_m = 60.0;  ///< entry cable
  double cable_m = 0.5;          ///< where no controller place is given
  double joint_pf = 2.0;
  double pin_pf = 10.0;                 ///< converter and multiplexer of a module on the line
  double switch_pf = 6.0;               ///< bus switch of a module that the line passes
  bool all_lines_on_all_joints = true;  ///< false: a line ends at its last module
};

enum class RouteObjective { kLossFirst, kHopsFirst };

struct RoutingOptions {
  int capacity = 16;
  int lines = 4;
  int addresses = 4;
  std::uint64_t seed = 1;
  double time_limit_s = 2.0;
  bool failure_analysis = true;
  bool milp = true;  ///< CBC as a last resort when bounds do not meet; only where time_limit_s ≥ 10
  RouteObjective objective = RouteObjective::kLossFirst;
  ElectricalModel electrical;
  bool second_entry = true;           ///< plan a second connector where it saves modules
  bool adoption = true;               ///< let neighbouring patches with free addresses read orphans
  int recombinations = 60;            ///< secondary-cost moves a patch; 0: keep the first partition
  bool has_controller_place = false;  ///< cable lengths count in the secondary cost
  std::array<double, 3> controller_mm{};
};

struct RoutingResult {
  std::vector<Patch> patches;
  int lower_bound = 0;  ///< no partition has fewer patches
  bool proved = false;  ///< patches.size() == lower_bound
  int line_hops = 0;
  int max_depth = 0;
  double mean_loss = 0.0;  ///< extra modules lost, beyond the failed one: mean over all single failures of modules and
                           ///< tree joints, lost_backed_up
  double seconds = 0.0;
  double mean_loss_one_entry = 0.0;  ///< the same with rerouting in the patch only
  double mean_loss_strapped = 0.0;   ///< the same without rerouting
  int patches_without_border = 0;
  int electrical_violations = 0;
  std::string
      proof;  ///< how the bound was met: size, folding, frontier, milp; the weakest over the islands, empty when open
};

/// A pair of free module sides of different islands that a jumper can bridge.
struct Jumper {
  std::array<int, 2> node{};
  std::array<int, 2> side{};
  double length_mm = 0.0;
};
/// Free sides of different islands whose midpoints lie within max_length_mm and whose outward directions face each
/// other (angle above 120°). Shortest first, each side and each pair of modules once. `side_mm[v][s]`: midpoint of
/// side s; node.center_mm must be set. Cost: O(sides · log sides) with sides sorted along x.
[[nodiscard]] std::vector<Jumper> find_jumpers(const ModuleGraph& graph,
                                               const std::vector<std::array<std::array<double, 3>, 3>>& side_mm,
                                               double max_length_mm);
/// The graph with the jumpers as joints; their sides are no border any more.
[[nodiscard]] ModuleGraph with_jumpers(ModuleGraph graph, const std::vector<Jumper>& jumpers);

/// Divides the graph into the fewest connected patches and wires each one: border entry, then least lines against the
/// electrical rule, least expected loss (sum of depths), least line hops, least depth; exact over all trees and
/// entries. Deterministic for a seed on every machine and compiler. Throws InputError for asymmetric joints or
/// impossible options.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options = {},
                                  const ProgressSink& progress = {});

/// Interval of the fewest controllers from the integer programme alone (CBC), island by island: the reference that
/// `bench routing` measures against. `upper` is 0 when the time limit passed before a partition of each island was
/// found.
struct PartitionInterval {
  int lower = 0, upper = 0;
  double seconds = 0.0;
};
[[nodiscard]] PartitionInterval partition_by_milp(const ModuleGraph& graph, int capacity, double time_limit_s);

}  // namespace triskin::geometry
