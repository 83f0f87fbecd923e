// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scene_reader.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::hardware {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;
using Kind = Expectation::Kind;

struct BoundKey {
  const char* key;
  Kind kind;
};
constexpr std::array<BoundKey, 4> kBoundKeys{{{"more_than_n", Kind::kForceAbove},
                                              {"less_than_n", Kind::kForceBelow},
                                              {"more_than_counts", Kind::kCountsAbove},
                                              {"less_than_counts", Kind::kCountsBelow}}};

constexpr const char* kOneClaim =
    "must say one thing that is expected: \"more_than_n\", \"less_than_n\", \"more_than_counts\", "
    "\"less_than_counts\", \"pressed\", \"state\" or \"silent\"";

wire::ModuleState read_state(const JsonValue& v) {
  const auto state = kModuleStateNames.value(v.text());
  if (!state) v.fail("is not a state of a module; give " + kModuleStateNames.list());
  return *state;
}

void require_true(const JsonValue& v) {
  if (!v.boolean()) v.fail("must be true; a module that speaks has a \"state\"");
}

void read_claim(const JsonValue& v, Expectation& e) {
  int claims = 0;
  for (const BoundKey& bound : kBoundKeys) {
    if (!has(v, bound.key)) continue;
    ++claims;
    e.kind = bound.kind;
    e.bound = number_in(v[bound.key], -1e6, 1e6);
  }
  if (has(v, "pressed")) {
    ++claims;
    e.kind = v["pressed"].boolean() ? Kind::kPressed : Kind::kNotPressed;
  }
  if (has(v, "silent")) {
    ++claims;
    e.kind = Kind::kSilent;
    require_true(v["silent"]);
  }
  if (has(v, "state")) {
    ++claims;
    e.kind = Kind::kState;
    e.state = read_state(v["state"]);
  }
  if (claims != 1) v.fail(kOneClaim);
}

void require_sense(const JsonValue& v, const Expectation& e) {
  const bool of_module = e.kind == Kind::kState || e.kind == Kind::kSilent;
  if (of_module && e.module < 0) v[e.kind == Kind::kState ? "state" : "silent"].fail("needs \"module\"");
  if (of_module && e.taxel >= 0) v["taxel"].fail("has no state of its own; leave it out");
  if (e.kind == Kind::kSilent && !e.until_us) v["silent"].fail("needs \"until_s\": how long nothing is to come");
  if (e.once && !e.until_us) v["once"].fail("needs \"until_s\": the time in which it is to happen");
  if (e.kind == Kind::kSilent && e.once) v["once"].fail("has no meaning beside \"silent\"");
}

}  // namespace

Expectation read_expectation(const SceneNames& names, const JsonValue& v) {
  only_scene_keys(v, {"at_s", "until_s", "once", "part", "module", "taxel", "more_than_n", "less_than_n",
                      "more_than_counts", "less_than_counts", "pressed", "state", "silent"});
  require_part_of_robot(names, v);
  Expectation e;
  e.part = names.part;
  e.place = v.path();
  e.from_us = scene_time_us(v["at_s"]);
  if (has(v, "until_s")) e.until_us = scene_time_us(v["until_s"]);
  if (e.until_us && *e.until_us <= e.from_us) v["until_s"].fail("must be later than \"at_s\"");
  if (has(v, "module")) {
    e.module = names.module(v["module"]);
    e.number = design::number_of(names.design, e.module);
  }
  if (has(v, "taxel")) {
    if (e.module < 0) v["taxel"].fail("needs \"module\"");
    e.taxel = layout::TaxelIndex{v["taxel"].integer(0, 11)};
  }
  if (has(v, "once")) e.once = v["once"].boolean();
  read_claim(v, e);
  require_sense(v, e);
  return e;
}

}  // namespace triskin::hardware
