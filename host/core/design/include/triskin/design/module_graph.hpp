// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/module.hpp"

namespace triskin::design {

/// The modules and joints of the graph need wiring. A node is an index in `nodes`, 0 … n - 1. In the graph of a
/// design (graph_of) the node is the module id; in a ModuleList node k has the file's id ids[k]. The CAN address of a
/// controller is always called node address.
struct ModuleGraph {
  struct Node {
    /// Entry s is the node joined across tile side s, or −1; the relation is symmetric.
    std::array<int, 3> neighbour{-1, -1, -1};
    /// True means that an entry cable can reach side s; always false where a neighbour is joined.
    std::array<bool, 3> border{true, true, true};
    int island = 0;
    /// The centre is in the frame of the mesh and serves for cable lengths; zero means unknown.
    std::array<double, 3> center_mm{};
  };
  std::vector<Node> nodes;
};

/// Makes the graph of a layout: joints and jumpers become edges, and free sides become border. Node v is the module
/// with id v. Errors: std::out_of_range for a jumper of a module that the layout lacks. Cost: O(n).
[[nodiscard]] ModuleGraph graph_of(const ModuleLayout& layout);

/// Adds jumpers to a graph as joints; their sides are no longer border. Errors: std::out_of_range for a node or side
/// that the graph lacks. Cost: O(n).
[[nodiscard]] ModuleGraph with_jumpers(ModuleGraph graph, const std::vector<Jumper>& jumpers);

/// Returns the node joined to each side of a module, also by a jumper, or −1. Errors: std::out_of_range for an id
/// that the layout lacks. Cost: O(jumpers).
[[nodiscard]] std::array<int, 3> joined_to(const ModuleLayout& layout, int id);

}  // namespace triskin::design
