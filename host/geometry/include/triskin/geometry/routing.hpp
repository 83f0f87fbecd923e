// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
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
  int parent = -1;      ///< node, -1 for the entry module
  int rotation = 0;     ///< 0..2
  int line = 0;         ///< 0..3
  int address = 0;      ///< 0..3, CDC address 0x2C + address
  int depth = 0;        ///< 0 for the entry module
};

/// What one failure costs, in modules of the patch that are no longer read (the failed one included).
struct FailureLoss {
  int node = -1;             ///< failed module; for a joint: the child end in the tree, or either end
  int other_node = -1;       ///< -1: module failure; else the other end of the failed joint
  int lost_strapped = 0;     ///< without rerouting
  int lost_rerouted = 0;     ///< with rerouting over the surviving joints
  std::vector<std::array<int, 2>> backup_tree;  ///< (child, parent) pairs that differ from the normal tree
};

struct Patch {
  int entry = -1;                     ///< node; an entry has tree degree ≤ 2
  std::vector<RoutedModule> modules;  ///< ≤ 16, parents before children
  std::vector<std::array<int, 2>> cut_joints;  ///< joints inside the patch that carry no signal
  int line_hops = 0;                  ///< Σ over tree edges of the lines that are used below the edge
  int max_depth = 0;
  std::vector<FailureLoss> failures;
};

struct RoutingOptions {
  int capacity = 16;
  int lines = 4;
  int addresses = 4;
  std::uint64_t seed = 1;
  double time_limit_s = 2.0;
  bool failure_analysis = true;
  bool milp = true;  ///< CBC as a last resort when bounds do not meet
};

struct RoutingResult {
  std::vector<Patch> patches;
  int lower_bound = 0;   ///< no partition has fewer patches
  bool proved = false;   ///< patches.size() == lower_bound
  int line_hops = 0;
  int max_depth = 0;
  double mean_loss = 0.0;  ///< mean over single failures of lost_rerouted
  double seconds = 0.0;
};

/// Divides the graph into the fewest connected patches and wires each one. Deterministic for a seed.
[[nodiscard]] RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options = {},
                                  const ProgressSink& progress = {});

}  // namespace triskin::geometry
