// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/module.hpp"

namespace triskin::design {

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

/// The graph of a layout: its joints, and free sides as border.
[[nodiscard]] ModuleGraph graph_of(const ModuleLayout& layout);

}  // namespace triskin::design
