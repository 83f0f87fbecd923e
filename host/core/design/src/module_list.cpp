// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/module_list.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::design {

namespace {

constexpr int kMaxId = 0x7FFFFFFE;

// A tile occurs once in an island.
using NodeAt = std::map<std::pair<int, Tile>, int>;

Tile read_tile(const JsonValue& m) {
  return {m["i"].integer(-kMaxLattice, kMaxLattice), m["j"].integer(-kMaxLattice, kMaxLattice), m["up"].boolean()};
}

void add_module(const JsonValue& m, ModuleList& list, NodeAt& node_at) {
  const Tile tile = read_tile(m);
  ModuleGraph::Node node;
  if (has(m, "island")) node.island = m["island"].integer(0, kMaxId);
  if (has(m, "border")) node.border.fill(m["border"].boolean());
  const auto [entry, is_new] = node_at.try_emplace({node.island, tile}, static_cast<int>(list.tiles.size()));
  if (!is_new) m.fail(fmt::format("lies on the tile of module {}", list.ids[static_cast<std::size_t>(entry->second)]));
  list.tiles.push_back(tile);
  list.graph.nodes.push_back(node);
}

void join_neighbours(ModuleList& list, const NodeAt& node_at) {
  for (std::size_t k = 0; k < list.tiles.size(); ++k) {
    ModuleGraph::Node& node = list.graph.nodes[k];
    for (int s = 0; s < 3; ++s) {
      const auto found = node_at.find({node.island, across(list.tiles[k], s).tile});
      if (found == node_at.end()) continue;
      node.neighbour[static_cast<std::size_t>(s)] = found->second;
      node.border[static_cast<std::size_t>(s)] = false;
    }
  }
}

}  // namespace

ModuleList read_module_list(const std::filesystem::path& path) {
  const nlohmann::json document = parse_json(read_text(path), path.string());
  const JsonValue modules = JsonValue(document, path.string())["modules"];
  if (modules.size() == 0) modules.fail("is empty; give at least one module");
  ModuleList list;
  NodeAt node_at;
  std::set<int> seen;
  for (std::size_t k = 0; k < modules.size(); ++k) {
    const JsonValue id = modules.at(k)["id"];
    list.ids.push_back(id.integer(0, kMaxId));
    if (!seen.insert(list.ids.back()).second) id.fail(fmt::format("{} appears twice", list.ids.back()));
    add_module(modules.at(k), list, node_at);
  }
  join_neighbours(list, node_at);
  return list;
}

}  // namespace triskin::design
