// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "routed_patch.hpp"
#include "triskin/base/error.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

const json& key(const json& object, const char* name, const std::string& where) {
  if (!object.is_object() || !object.contains(name))
    throw InputError(fmt::format("{}: \"{}\" is missing; write the file with triskin route -o", where, name));
  return object.at(name);
}
int integer(const json& object, const char* name, const std::string& where) {
  const json& value = key(object, name, where);
  if (!value.is_number_integer())
    throw InputError(fmt::format("{}: \"{}\" must be an integer, is {}", where, name, value.dump()));
  return value.get<int>();
}
bool boolean(const json& object, const char* name, const std::string& where) {
  const json& value = key(object, name, where);
  if (!value.is_boolean())
    throw InputError(fmt::format("{}: \"{}\" must be true or false, is {}", where, name, value.dump()));
  return value.get<bool>();
}
const json& list_in(const json& object, const char* name, const std::string& where) {
  const json& value = key(object, name, where);
  if (!value.is_array()) throw InputError(fmt::format("{}: \"{}\" must be a list", where, name));
  return value;
}
std::vector<std::array<int, 2>> pairs(const json& object, const char* name, const std::string& where) {
  std::vector<std::array<int, 2>> result;
  for (const json& p : list_in(object, name, where)) {
    if (!p.is_array() || p.size() != 2 || !p[0].is_number_integer() || !p[1].is_number_integer()) {
      throw InputError(fmt::format("{}: \"{}\" must hold pairs of ids, holds {}", where, name, p.dump()));
    }
    result.push_back({p[0].get<int>(), p[1].get<int>()});
  }
  return result;
}

// Sides are numbered as documented: 0, 1, 2 counter-clockwise from the bottom of an up tile, from the right of a down
// tile.
std::array<int, 3> tile_beyond(const std::array<int, 3>& t, int side) {
  static constexpr int kFromUp[3][2] = {{0, -1}, {0, 0}, {-1, 0}}, kFromDown[3][2] = {{1, 0}, {0, 1}, {0, 0}};
  const auto& d = t[2] != 0 ? kFromUp[side] : kFromDown[side];
  return {t[0] + d[0], t[1] + d[1], 1 - t[2]};
}

}  // namespace

ModuleMap read_listed_modules(const json& document) {
  ModuleMap modules;
  std::map<std::pair<int, std::array<int, 3>>, int> at_tile;
  for (const json& m : list_in(document, "modules", "module list")) {
    const std::string where = "module list";
    const int id = integer(m, "id", where), island = m.contains("island") ? integer(m, "island", where) : 0;
    const std::array<int, 3> tile{integer(m, "i", where), integer(m, "j", where), boolean(m, "up", where) ? 1 : 0};
    at_tile[{island, tile}] = id;
    modules[id].border = !m.contains("border") || boolean(m, "border", where);
  }
  for (const auto& [place, id] : at_tile) {
    for (int s = 0; s < 3; ++s) {
      const auto found = at_tile.find({place.first, tile_beyond(place.second, s)});
      if (found != at_tile.end()) modules[id].beside[static_cast<std::size_t>(s)] = found->second;
    }
  }
  return modules;
}

RouteDocument read_route_document(const json& document) {
  const std::string where = "routes";
  RouteDocument d{{},
                  integer(document, "patches", where),
                  integer(document, "lower_bound", where),
                  integer(document, "line_hops", where),
                  integer(document, "max_depth", where),
                  boolean(document, "proved", where),
                  key(document, "mean_loss", where).get<double>()};
  for (const json& p : list_in(document, "routes", where)) {
    const std::string name = fmt::format("patch {}", d.patches.size());
    RoutePatch patch{integer(p, "entry", name),
                     integer(p, "second_entry", name),
                     integer(p, "second_entry_side", name),
                     integer(p, "line_hops", name),
                     integer(p, "max_depth", name),
                     boolean(p, "border_entry", name),
                     boolean(p, "second_entry_border", name),
                     {},
                     pairs(p, "cut_joints", name),
                     {}};
    for (const json& m : list_in(p, "modules", name)) {
      patch.rows.push_back({integer(m, "id", name), integer(m, "parent", name), integer(m, "rotation", name),
                            integer(m, "line", name), integer(m, "address", name), integer(m, "depth", name)});
    }
    for (const json& f : list_in(p, "failures", name)) {
      patch.failures.push_back({integer(f, "module", name), integer(f, "other", name),
                                integer(f, "lost_strapped", name), integer(f, "lost_rerouted", name),
                                integer(f, "lost_one_entry", name), integer(f, "lost_backed_up", name),
                                pairs(f, "backup", name), pairs(f, "adopted", name)});
    }
    d.patches.push_back(std::move(patch));
  }
  return d;
}

}  // namespace triskin::check
