// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "route_grid.hpp"

namespace triskin::fabrication {

/// What a net has to join: each pad is a list of nodes of the grid, any of which may be reached.
struct NetPads {
  int net = 0;
  std::vector<int> start;              ///< Copper that hangs together already, such as a ring with its contacts.
  std::vector<std::vector<int>> pads;  ///< Each of them gets a path to the rest.
};

/// A path of one net, from node to neighbouring node; equal places on successive layers are a hole.
struct NetPath {
  int net = 0;
  int pad = 0;  ///< The path ends in this one of NetPads::pads.
  std::vector<int> nodes;
};

/// Joins the pads of every net by paths that keep the clearance of each other. All nets are routed as if the others
/// were cheap to cross; what is crossed grows dearer until nothing is (McMurchie and Ebeling, PathFinder, 1995).
/// Cost: rounds × paths × nodes of the grid. Errors: std::logic_error if places remain that two nets want.
[[nodiscard]] std::vector<NetPath> route_nets(const RouteGrid& grid, const std::vector<NetPads>& nets);

}  // namespace triskin::fabrication
