// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/routing.hpp"

namespace triskin::model {

/// Modules from elsewhere, as `triskin route` reads them (docs/cli.md): lattice places, optional island and border.
struct ModuleList {
  std::vector<int> ids;  ///< of node k
  std::vector<geometry::Tile> tiles;
  geometry::ModuleGraph graph;  ///< joined where two tiles of one island share a side
};

/// Throws InputError naming file and key: wrong types, an id or a tile of an island that stands twice, no module.
[[nodiscard]] ModuleList read_module_list(const std::filesystem::path& path);

/// The graph of a layout: its joints, and free sides as border.
[[nodiscard]] geometry::ModuleGraph graph_of(const geometry::ModuleLayout& layout);

}  // namespace triskin::model
