// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/layout/module.hpp"

namespace triskin::design {

/// Modules that one controller reads at most.
inline constexpr int kModulesAController = layout::kMaxModules;

/// One module in a patch, named by its node in the ModuleGraph that was routed (in a design: the module id). `rotation`
/// r: the module is turned so that its input port (port 0 = A) lies at tile side r; port p lies at tile side (p + r)
/// % 3. The input port faces the parent; that of the entry module faces the cable.
struct RoutedModule {
  int node = -1;     ///< It is an index in ModuleGraph::nodes, and in a design the module id.
  int parent = -1;   ///< It is the node of the parent, or −1 for the entry module.
  int rotation = 0;  ///< It ranges from 0 to 2.
  int line = 0;      ///< It ranges from 0 to 3.
  int address = 0;   ///< It ranges from 0 to 3; the CDC's address is 0x2C + address.
  int depth = 0;     ///< The entry module has depth 0.
};

/// Loss under one failure, in modules of the patch that are no longer read (the failed one included). Nodes as in
/// RoutedModule.
struct FailureLoss {
  int node = -1;  ///< It is the failed module's node; for a joint the child end in the tree, or either end.
  /// It is −1 for the failure of a module, otherwise the node at the other end of the failed joint.
  int other_node = -1;
  int lost_strapped = 0;  ///< Without rerouting the whole subtree is lost.
  /// Modules lost if switched modules are rerouted over the remaining joints from both entries (`backup_tree`).
  int lost_rerouted = 0;
  int lost_backed_up = 0;  ///< So many are lost even with the second entry and with adoption by neighbouring patches.
  /// It lists (child, parent) nodes that differ from the normal tree; a parent of −1 is the second entry.
  std::vector<std::array<int, 2>> backup_tree;
  /// It lists (child, parent) where another patch reads the child, parents first.
  std::vector<std::array<int, 2>> adopted;
  int lost_one_entry = 0;  ///< So many are lost if rerouting uses the first entry only, as a prepared route does.
};

/// Electrical state of one line of a patch; docs/routing.md has formulas and sources.
struct LineElectrical {
  int modules = 0;
  double capacitance_pf = 0.0;
  double pull_up_min_ohm = 0.0;  ///< The sink current sets this lower limit.
  double pull_up_max_ohm = 0.0;  ///< The rise time at the required bus speed sets this upper limit.
  double rise_time_ns = 0.0;     ///< It holds with the smallest pull-up.
  double max_bus_hz = 0.0;       ///< It is the highest safe standard speed, and 0 when none is.
};

/// One controller's modules as one wired tree. Every node is an index in the ModuleGraph that was routed.
struct Patch {
  int entry = -1;                     ///< It is a node; an entry has at most two neighbours in the tree.
  std::vector<RoutedModule> modules;  ///< There are at most 16, parents before children.
  /// They are joints (node, node) inside the patch that carry no signal.
  std::vector<std::array<int, 2>> cut_joints;
  int line_hops = 0;  ///< It sums over the tree's edges how many lines are used below the edge.
  int max_depth = 0;
  std::vector<FailureLoss> failures;
  bool border_entry = false;  ///< The entry's cable side is reached from outside.
  int second_entry = -1;      ///< A second connector saves most modules at this node; −1 means that none saves any.
  /// The side carries no joint of the patch: it is on the border, or at the seam to another patch.
  int second_entry_side = -1;
  bool second_entry_border = false;  ///< It is false when the cable has to pass through the skin.
  int second_entry_saves = 0;        ///< It counts saved modules, summed over all single failures.
  std::vector<int> articulation;     ///< If one of these nodes fails, others of the patch are disconnected.
  /// If one of these joints (node, node) fails, nodes of the patch are disconnected.
  std::vector<std::array<int, 2>> bridges;
  std::vector<LineElectrical> lines;  ///< There is one for each line.
  int electrical_violations = 0;      ///< It counts lines that are too heavy for the required bus speed.
};

}  // namespace triskin::design
