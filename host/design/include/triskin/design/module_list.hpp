// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/design/module.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/patch.hpp"

namespace triskin::design {

/// Modules from elsewhere, as `triskin route` reads them (docs/cli.md, Input of `route`): lattice places, optional
/// island and border.
struct ModuleList {
  std::vector<int> ids;  ///< of node k
  std::vector<Tile> tiles;
  ModuleGraph graph;  ///< joined where two tiles of one island share a side
};

/// Throws InputError naming file and key: wrong types, an id or a tile of an island that stands twice, no module.
[[nodiscard]] ModuleList read_module_list(const std::filesystem::path& path);

}  // namespace triskin::design
