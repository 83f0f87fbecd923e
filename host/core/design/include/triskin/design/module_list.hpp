// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/design/module.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/patch.hpp"

namespace triskin::design {

/// `triskin route MODULES` reads modules that belong to no design (docs/routing.md). The arrays are indexed by node;
/// the module at node k has the file's id ids[k], which need not be k.
struct ModuleList {
  std::vector<int> ids;     ///< The file's ids, indexed by node, are unique and not negative, in any order.
  std::vector<Tile> tiles;  ///< The tiles are indexed by node.
  ModuleGraph graph;        ///< Two nodes are joined if their tiles share a side and belong to one island.
};

/// Reads a JSON file {"modules": [{"id", "i", "j", "up", optional "island" and "border"}, …]}: id, island >= 0, |i|
/// and
/// |j| <= 10⁶. Errors: InputError with file and key for a file that cannot be read or is no JSON, wrong types and
/// ranges, an id that occurs twice, a tile that occurs twice in an island, and a list without a module. Cost: O(n log
/// n).
[[nodiscard]] ModuleList read_module_list(const std::filesystem::path& path);

}  // namespace triskin::design
