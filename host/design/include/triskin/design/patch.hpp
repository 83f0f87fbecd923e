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
  int node = -1;     ///< index in ModuleGraph::nodes; in a design the module id
  int parent = -1;   ///< node of the parent, -1 for the entry module
  int rotation = 0;  ///< 0..2
  int line = 0;      ///< 0..3
  int address = 0;   ///< 0..3, CDC address 0x2C + address
  int depth = 0;     ///< 0 for the entry module
};

/// Loss under one failure, in modules of the patch that are no longer read (the failed one included). Nodes as in
/// RoutedModule.
struct FailureLoss {
  int node = -1;          ///< node of the failed module; for a joint: the child end in the tree, or either end
  int other_node = -1;    ///< -1: module failure; else the node at the other end of the failed joint
  int lost_strapped = 0;  ///< modules lost without rerouting: the subtree
  /// Modules lost if switched modules are rerouted over the remaining joints from both entries (`backup_tree`).
  int lost_rerouted = 0;
  int lost_backed_up = 0;  ///< also with the second entry and with adoption by neighbouring patches
  std::vector<std::array<int, 2>>
      backup_tree;  ///< (child, parent) nodes that differ from the normal tree; parent -1: the second entry
  std::vector<std::array<int, 2>> adopted;  ///< (child, parent) if the child is read by another patch; parents first
  int lost_one_entry = 0;  ///< modules lost if rerouting uses the first entry only, as a prepared route does
};

/// Electrical state of one line of a patch; docs/routing.md has formulas and sources.
struct LineElectrical {
  int modules = 0;
  double capacitance_pf = 0.0;
  double pull_up_min_ohm = 0.0;  ///< lower limit, from the sink current
  double pull_up_max_ohm = 0.0;  ///< upper limit, from the rise time at the required bus speed
  double rise_time_ns = 0.0;     ///< rise time with the smallest pull-up
  double max_bus_hz = 0.0;       ///< highest safe standard speed; 0 when none is
};

/// One controller's modules as one wired tree. Every node is an index in the ModuleGraph that was routed.
struct Patch {
  int entry = -1;                              ///< node; an entry has tree degree ≤ 2
  std::vector<RoutedModule> modules;           ///< ≤ 16, parents before children
  std::vector<std::array<int, 2>> cut_joints;  ///< joints (node, node) inside the patch that carry no signal
  int line_hops = 0;                           ///< Σ over tree edges of the lines that are used below the edge
  int max_depth = 0;
  std::vector<FailureLoss> failures;
  bool border_entry = false;         ///< the entry's cable side is reached from outside
  int second_entry = -1;             ///< node where a second connector saves most modules; -1: none saves any
  int second_entry_side = -1;        ///< carries no joint of the patch: on the border, or at the seam to another patch
  bool second_entry_border = false;  ///< false: its cable passes through the skin
  int second_entry_saves = 0;        ///< modules, summed over all single failures
  std::vector<int> articulation;     ///< nodes whose failure disconnects others of the patch
  std::vector<std::array<int, 2>> bridges;  ///< joints (node, node) whose failure does
  std::vector<LineElectrical> lines;        ///< one per line
  int electrical_violations = 0;            ///< lines too heavy for the required bus speed
};

}  // namespace triskin::design
