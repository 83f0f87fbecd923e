// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/layout/module.hpp"

namespace triskin::design {

/// A controller reads at most this many modules.
inline constexpr int kModulesAController = layout::kMaxModules;

/// A module in a patch is named by its node in the ModuleGraph that was routed (in a design: the module id). A module
/// with `rotation` r is turned so that its input port (port 0 = A) lies at tile side r and port p at tile side (p + r)
/// % 3. The input port faces the parent, or the cable at the entry module.
struct RoutedModule {
  int node = -1;     ///< The node is an index in ModuleGraph::nodes, and in a design the module id.
  int parent = -1;   ///< The parent is a node; the entry module has −1.
  int rotation = 0;  ///< Valid values are 0 to 2.
  int line = 0;      ///< Valid values are 0 to 3.
  int address = 0;   ///< Valid values are 0 to 3; the CDC's address is 0x2C + address.
  int depth = 0;     ///< The entry module has depth 0.
};

/// Loss caused by one failure, in modules of the patch that are no longer read (including the failed one). Nodes are
/// those of RoutedModule.
struct FailureLoss {
  /// The failed module has this node; for a joint it is the child end in the tree, or either end outside it.
  int node = -1;
  /// A module failure has −1; for a joint this is the node at the other end.
  int other_node = -1;
  int lost_strapped = 0;  ///< Strapped modules cannot be rerouted, so the whole subtree is lost.
  /// This many are lost if switched modules are rerouted over the remaining joints from both entries (`backup_tree`).
  int lost_rerouted = 0;
  int lost_backed_up = 0;  ///< This many are lost even with the second entry and with adoption by neighbouring patches.
  /// The list has the (child, parent) nodes that differ from the normal tree; a parent of −1 is the second entry.
  std::vector<std::array<int, 2>> backup_tree;
  /// The list has (child, parent) pairs whose child another patch reads; parents are listed first.
  std::vector<std::array<int, 2>> adopted;
  int lost_one_entry = 0;  ///< This many are lost if rerouting uses the first entry only, as a prepared route does.
};

/// docs/routing.md has formulas and sources for the electrical state of a line.
struct LineElectrical {
  int modules = 0;
  double capacitance_pf = 0.0;
  double pull_up_min_ohm = 0.0;  ///< The sink current sets this lower limit.
  double pull_up_max_ohm = 0.0;  ///< The rise time at the required bus speed sets this upper limit.
  double rise_time_ns = 0.0;     ///< The rise time applies to the smallest pull-up.
  double max_bus_hz = 0.0;       ///< This is the highest standard speed that is safe; 0 means that none is.
};

/// The modules of one controller form a wired tree. Every node is an index in the ModuleGraph that was routed.
struct Patch {
  /// In a list of patches the index is the number of the controller. Where a change of the design left a number without
  /// a controller, a patch without modules stands for it, so that the others keep theirs.
  [[nodiscard]] bool is_gap() const { return modules.empty(); }

  int entry = -1;                     ///< The entry is given as a node; it has at most two neighbours in the tree.
  std::vector<RoutedModule> modules;  ///< A patch has at most 16 modules, listed with parents before children.
  /// These joints (node, node) lie inside the patch but carry no signal.
  std::vector<std::array<int, 2>> cut_joints;
  int line_hops = 0;  ///< The sum runs over the tree's edges and counts how many lines are used below each edge.
  int max_depth = 0;
  std::vector<FailureLoss> failures;
  bool border_entry = false;  ///< True means that the entry's cable side can be reached from outside.
  /// A second connector at this node saves the most modules; −1 means that it saves none anywhere.
  int second_entry = -1;
  /// This side has no joint of the patch: it is on the border, or at the seam to another patch.
  int second_entry_side = -1;
  bool second_entry_border = false;  ///< False means that the cable has to pass through the skin.
  int second_entry_saves = 0;        ///< The number of saved modules is summed over all single failures.
  std::vector<int> articulation;     ///< If one of these nodes fails, other nodes of the patch are disconnected.
  /// If one of these joints (node, node) fails, nodes of the patch are disconnected.
  std::vector<std::array<int, 2>> bridges;
  std::vector<LineElectrical> lines;
  int electrical_violations = 0;  ///< Lines count here if they are too heavy for the required bus speed.
};

}  // namespace triskin::design
