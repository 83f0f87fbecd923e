// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/module_list.hpp"

#include <map>
#include <set>

#include "triskin/base/text_file.hpp"
#include "triskin/design/json_value.hpp"

namespace triskin::design {

ModuleList read_module_list(const std::filesystem::path& path) {
  const nlohmann::json document = parse_json(read_text(path), path.string());
  const JsonValue modules = JsonValue(document, path.string(), "")["modules"];
  if (modules.size() == 0) modules.fail("is empty; give at least one module");
  ModuleList list;
  std::map<std::pair<int, Tile>, int> place;
  std::set<int> seen;
  for (std::size_t k = 0; k < modules.size(); ++k) {
    const JsonValue m = modules.at(k);
    const int id = m["id"].integer(0, 0x7FFFFFFE);
    if (!seen.insert(id).second) m["id"].fail(fmt::format("{} stands twice", id));
    const Tile tile{m["i"].integer(-kMaxLattice, kMaxLattice), m["j"].integer(-kMaxLattice, kMaxLattice),
                    m["up"].boolean()};
    ModuleGraph::Node node;
    if (has(m, "island")) node.island = m["island"].integer(0, 0x7FFFFFFE);
    if (has(m, "border")) node.border.fill(m["border"].boolean());
    const auto [entry, is_new] = place.try_emplace({node.island, tile}, static_cast<int>(k));
    if (!is_new)
      m.fail(fmt::format("lies on the tile of module {}", list.ids[static_cast<std::size_t>(entry->second)]));
    list.ids.push_back(id);
    list.tiles.push_back(tile);
    list.graph.nodes.push_back(node);
  }
  for (std::size_t k = 0; k < list.tiles.size(); ++k) {
    ModuleGraph::Node& node = list.graph.nodes[k];
    for (int s = 0; s < 3; ++s) {
      const auto found = place.find({node.island, across(list.tiles[k], s).tile});
      if (found == place.end()) continue;
      node.neighbour[static_cast<std::size_t>(s)] = found->second;
      node.border[static_cast<std::size_t>(s)] = false;
    }
  }
  return list;
}

}  // namespace triskin::design
