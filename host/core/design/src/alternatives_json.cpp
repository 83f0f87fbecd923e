// SPDX-License-Identifier: GPL-3.0-or-later
#include "alternatives_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "triskin/design/json_fields.hpp"

namespace triskin::design {
namespace {

using nlohmann::json;

constexpr double kMaxPrice = 1e12;

json place_json(const PlacedModule& m) {
  json corners = json::array();
  for (const Vec3& c : m.corner_mm) corners.push_back({c.x(), c.y(), c.z()});
  return {
      {"island", m.island},       {"i", m.tile.i}, {"j", m.tile.j}, {"up", m.tile.up}, {"corners", std::move(corners)},
      {"neighbours", m.neighbour}};
}

PlacedModule read_place(const JsonValue& v, std::size_t n_modules) {
  only_keys(v, {"island", "i", "j", "up", "corners", "neighbours"}, "docs/design_file.md");
  PlacedModule m;
  m.island = v["island"].integer(0, kMaxCount);
  m.tile = {v["i"].integer(-kMaxLattice, kMaxLattice), v["j"].integer(-kMaxLattice, kMaxLattice), v["up"].boolean()};
  const JsonValue corners = v["corners"], neighbours = v["neighbours"];
  corners.require_size(3);
  neighbours.require_size(3);
  for (std::size_t k = 0; k < 3; ++k) {
    m.corner_mm[k] = vec3(corners.at(k));
    m.neighbour[k] = neighbours.at(k).integer(-1, static_cast<int>(n_modules) - 1);
  }
  return m;
}

json alternative_json(const Alternative& a) {
  json places = json::array();
  for (const PlacedModule& m : a.layout.modules) places.push_back(place_json(m));
  return {{"modules", a.layout.modules.size()},
          {"patches", a.patches},
          {"jumpers", a.jumpers},
          {"islands", a.layout.islands},
          {"price", a.price},
          {"method", kLayoutMethodNames.name(a.layout.method)},
          {"places", std::move(places)}};
}

Alternative read_alternative(const JsonValue& v) {
  only_keys(v, {"modules", "patches", "jumpers", "islands", "price", "method", "places", "worth"},
            "docs/design_file.md");
  Alternative a;
  a.patches = v["patches"].integer(0, kMaxCount);
  a.jumpers = v["jumpers"].integer(0, kMaxCount);
  a.layout.islands = v["islands"].integer(0, kMaxCount);
  a.price = number_in(v["price"], 0.0, kMaxPrice);
  const auto method = kLayoutMethodNames.value(v["method"].text());
  if (!method) v["method"].fail("must be " + kLayoutMethodNames.list());
  a.layout.method = *method;
  const JsonValue places = v["places"];
  for (std::size_t k = 0; k < places.size(); ++k) a.layout.modules.push_back(read_place(places.at(k), places.size()));
  if (v["modules"].integer(0, kMaxCount) != static_cast<int>(places.size()))
    v["modules"].fail(fmt::format("must be the number of places, {}", places.size()));
  return a;
}

}  // namespace

void write_alternatives(const Design& design, json& document) {
  if (design.alternatives.empty()) return;
  const Price& p = design.price;
  document["price"] = {{"controller", p.controller}, {"jumper", p.jumper}, {"island", p.island}};
  document["limits"]["jumper_mm"] = design.limits.jumper_mm;
  document["taken"] = design.taken;
  for (const Alternative& a : design.alternatives) document["alternatives"].push_back(alternative_json(a));
}

void read_alternatives(const JsonValue& v, Design& design) {
  if (!v.raw().contains("alternatives")) return;
  const JsonValue price = v["price"], list = v["alternatives"];
  only_keys(price, {"controller", "jumper", "island"}, "docs/design_file.md");
  const auto price_of = [&price](const char* key) { return number_in(price[key], 0.0, kMaxPrice); };
  design.price = {price_of("controller"), price_of("jumper"), price_of("island")};
  for (std::size_t k = 0; k < list.size(); ++k) design.alternatives.push_back(read_alternative(list.at(k)));
  for (Alternative& a : design.alternatives) a.layout.corner_cut_mm = design.layout.corner_cut_mm;
  design.taken = v["taken"].integer(-1, static_cast<int>(list.size()) - 1);
}

}  // namespace triskin::design
