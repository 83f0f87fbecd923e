// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/design/module.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/patch.hpp"

namespace triskin::design {

/// Modules that no design holds, as `triskin route MODULES` reads them (docs/routing.md). Arrays by node: the module at
/// node k has the file's id ids[k], which need not be k.
struct ModuleList {
  std::vector<int> ids;     ///< They are the ids in the file, indexed by node: unique, not negative, in any order.
  std::vector<Tile> tiles;  ///< They are indexed by node.
  ModuleGraph graph;        ///< Nodes are joined where two tiles of one island share a side.
};

/// Reads a JSON file {"modules": [{"id", "i", "j", "up", optional "island" and "border"}, …]}: id, island >= 0, |i|
/// and |j| <= 10⁶. Errors: InputError with file and key for a file that cannot be read or is no JSON, wrong types and
/// ranges, an id that stands twice, a tile that stands twice in an island, and a list without a module. Cost: O(n log
/// n).
[[nodiscard]] ModuleList read_module_list(const std::filesystem::path& path);

}  // namespace triskin::design
