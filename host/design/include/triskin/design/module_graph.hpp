// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/module.hpp"

namespace triskin::design {

/// Modules and joints to be wired. A node is an index in `nodes`, 0 … n - 1, and nothing else: the graph of a design
/// (graph_of) has node = module id; in a ModuleList node k has the file's id ids[k]; the CAN address of a controller is
/// always called node address.
struct ModuleGraph {
  /// One module.
  struct Node {
    std::array<int, 3> neighbour{-1, -1, -1};  ///< It is the node joined across tile side s, or −1, and is symmetric.
    /// An entry cable can reach side s; always false where a neighbour is joined.
    std::array<bool, 3> border{true, true, true};
    int island = 0;
    std::array<double, 3> center_mm{};  ///< It is in the frame of the mesh, for cable lengths, and zero when unknown.
  };
  std::vector<Node> nodes;
};

/// The graph of a layout: its joints, jumpers among them, and free sides as border; node v is the module with id v.
/// Errors: std::out_of_range for a jumper of a module that the layout lacks. Cost: O(n).
[[nodiscard]] ModuleGraph graph_of(const ModuleLayout& layout);

/// The graph with jumpers as joints; their sides are no border any more. Errors: std::out_of_range for a node or side
/// that the graph lacks. Cost: O(n).
[[nodiscard]] ModuleGraph with_jumpers(ModuleGraph graph, const std::vector<Jumper>& jumpers);

/// What is joined to each side of a module, over jumpers too: node, or -1. Errors: std::out_of_range for an id that the
/// layout lacks. Cost: O(jumpers).
[[nodiscard]] std::array<int, 3> joined_to(const ModuleLayout& layout, int id);

}  // namespace triskin::design
