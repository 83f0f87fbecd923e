// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "scene_reader.hpp"
#include "triskin/hardware/skin_place.hpp"

namespace triskin::hardware {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;
using design::Vec3;

constexpr double kMaxRadius_mm = 1000.0;
constexpr double kMaxForce_n = 1000.0;
constexpr std::size_t kMaxKeyframes = 100'000;
constexpr std::array<const char*, 4> kPlaces{"position_mm", "module", "nearest_to_mm", "ray"};

bool has_place(const JsonValue& v) {
  return std::ranges::any_of(kPlaces, [&](const char* key) { return has(v, key); });
}

Vec3 on_module(const SceneNames& names, const JsonValue& v) {
  const layout::ModuleId m = names.module(v["module"]);
  if (!has(v, "taxel")) return center_of(names.design, m);
  const int taxel = v["taxel"].integer(0, 11);
  if (!layout::measures_pressure(static_cast<std::size_t>(taxel)))
    v["taxel"].fail(fmt::format("pad {} measures temperature and feels no finger; choose another taxel", taxel));
  const auto k = static_cast<std::size_t>(m);
  return design::taxels_of(names.design.layout.modules[k],
                           names.wiring[k].routed.rotation)[static_cast<std::size_t>(taxel)]
      .position_mm;
}

Vec3 nearest_to(const SceneNames& names, const JsonValue& v) {
  const auto place = nearest_place(names.design, scene_point_mm(v));
  if (!place) v.fail("the design has no module");
  return place->position_mm;
}

Vec3 hit_by(const SceneNames& names, const JsonValue& v) {
  only_scene_keys(v, {"from_mm", "direction"});
  const Vec3 from_mm = scene_point_mm(v["from_mm"]), direction = scene_point_mm(v["direction"]);
  if (!(direction.norm() > 0.0)) v["direction"].fail("has no length; give a vector such as [0, 0, -1]");
  const auto place = place_on_ray(names.design, from_mm, direction);
  if (!place) v.fail("passes by the skin; let it point at a module, from outside");
  return place->position_mm;
}

// Reads a place, which `v` may name in one of four ways.
Vec3 read_place(const SceneNames& names, const JsonValue& v) {
  const auto named = std::ranges::count_if(kPlaces, [&](const char* key) { return has(v, key); });
  if (named != 1)
    v.fail("needs either \"position_mm\" or \"module\" or \"nearest_to_mm\" or \"ray\": one of them says where");
  if (has(v, "taxel") && !has(v, "module")) v["taxel"].fail("needs \"module\"");
  if (has(v, "module")) return on_module(names, v);
  if (has(v, "nearest_to_mm")) return nearest_to(names, v["nearest_to_mm"]);
  return has(v, "ray") ? hit_by(names, v["ray"]) : scene_point_mm(v["position_mm"]);
}

double read_radius_mm(const JsonValue& v, double otherwise) {
  return has(v, "radius_mm") ? number_in(v["radius_mm"], 0.1, kMaxRadius_mm) : otherwise;
}
double read_force_n(const JsonValue& v, double otherwise) {
  return has(v, "force_n") ? number_in(v["force_n"], 0.0, kMaxForce_n) : otherwise;
}

// A keyframe keeps what it does not name: place, radius and force of the one before, the first those of the contact
// `v`.
void read_frames(const SceneNames& names, const JsonValue& v, const JsonValue& list, Contact& c) {
  if (list.size() == 0 || list.size() > kMaxKeyframes)
    list.fail(fmt::format("must have 1 … {} keyframes", kMaxKeyframes));
  std::optional<Vec3> at;
  if (has_place(v)) at = read_place(names, v);
  Keyframe frame{0, {}, c.radius_mm, c.force_n};
  for (std::size_t k = 0; k < list.size(); ++k) {
    const JsonValue f = list.at(k);
    only_scene_keys(f, {"at_s", "position_mm", "module", "taxel", "nearest_to_mm", "ray", "radius_mm", "force_n"});
    const std::uint64_t at_us = scene_time_us(f["at_s"]);
    if (k == 0) c.from_us = at_us;
    if (at_us < c.from_us + frame.after_us) f["at_s"].fail("is earlier than the keyframe before; sort them by time");
    if (has_place(f)) at = read_place(names, f);
    if (!at) f.fail("needs a place: \"position_mm\", \"module\", \"nearest_to_mm\" or \"ray\"");
    frame = {at_us - c.from_us, *at, read_radius_mm(f, frame.radius_mm), read_force_n(f, frame.force_n)};
    c.keyframes.push_back(frame);
  }
}

void read_keyframes(const SceneNames& names, const JsonValue& v, Contact& c) {
  for (const char* key : {"at_s", "to_mm", "to", "rise_s", "fall_s"})
    if (has(v, key)) v[key].fail("has no meaning beside \"keyframes\", which say it; leave it out");
  const JsonValue list = v["keyframes"];
  read_frames(names, v, list, c);
  c.position_mm = c.keyframes[0].position_mm;
  const std::uint64_t last_us = c.from_us + c.keyframes.back().after_us;
  if (has(v, "until_s") && c.until_us < last_us) v["until_s"].fail("is earlier than the last keyframe");
  if (!has(v, "until_s") && list.size() > 1) c.until_us = last_us;
}

void read_simple(const SceneNames& names, const JsonValue& v, Contact& c) {
  if (has(v, "at_s")) c.from_us = scene_time_us(v["at_s"]);
  c.position_mm = read_place(names, v);
  if (has(v, "to_mm") && has(v, "to")) v["to"].fail("says the same as \"to_mm\"; leave one out");
  if (has(v, "to_mm")) c.to_mm = scene_point_mm(v["to_mm"]);
  if (has(v, "to")) {
    only_scene_keys(v["to"], {"position_mm", "module", "taxel", "nearest_to_mm", "ray"});
    c.to_mm = read_place(names, v["to"]);
  }
  for (const char* key : {"to_mm", "to", "fall_s"})
    if (has(v, key) && c.until_us == kForever) v[key].fail("needs \"until_s\": the time at which it ends");
  if (has(v, "rise_s")) c.rise_us = scene_time_us(v["rise_s"]);
  if (has(v, "fall_s")) c.fall_us = scene_time_us(v["fall_s"]);
  if (c.until_us != kForever && c.until_us > c.from_us && c.rise_us + c.fall_us > c.until_us - c.from_us)
    v[has(v, "fall_s") ? "fall_s" : "rise_s"].fail("the force rises and falls for longer than the contact lasts");
}

void read_repeats(const JsonValue& v, Contact& c) {
  if (has(v, "passes") && !has(v, "every_s")) v["passes"].fail("needs \"every_s\": the time from one pass to the next");
  if (!has(v, "every_s")) return;
  if (c.until_us == kForever) v["every_s"].fail("needs \"until_s\": the end of the first pass");
  c.every_us = scene_time_us(v["every_s"]);
  if (c.every_us < c.until_us - c.from_us)
    v["every_s"].fail(
        fmt::format("must be at least {:g}, the time of one pass", static_cast<double>(c.until_us - c.from_us) * 1e-6));
  if (has(v, "passes")) c.passes = v["passes"].integer(1, 1'000'000);
}

std::vector<Keyframe> as_keyframes(const Contact& c) {
  if (!c.keyframes.empty()) return c.keyframes;
  return {{0, c.position_mm, c.radius_mm, c.force_n},
          {c.until_us - c.from_us, c.to_mm.value_or(c.position_mm), c.radius_mm, c.force_n}};
}

// Returns the state at `part` (0 … 1) of the way from `a` to `b`.
Keyframe keyframe_between(const Keyframe& a, const Keyframe& b, double part) {
  return {a.after_us + static_cast<std::uint64_t>(part * static_cast<double>(b.after_us - a.after_us)),
          a.position_mm + part * (b.position_mm - a.position_mm), a.radius_mm + part * (b.radius_mm - a.radius_mm),
          a.force_n + part * (b.force_n - a.force_n)};
}

// A straight path leaves a curved skin, so its points are moved to the nearest ones on the skin.
void keep_on_skin(const SceneNames& names, const JsonValue& v, Contact& c) {
  if (!v["on_skin"].boolean()) return;
  if (!c.to_mm && c.keyframes.size() < 2) v["on_skin"].fail("has no meaning for a contact that does not move");
  if (c.rise_us != 0 || c.fall_us != 0) v["on_skin"].fail("goes with \"keyframes\" where the force rises or falls");
  constexpr double kStep_mm = 2.0;
  const std::vector<Keyframe> corners = as_keyframes(c);
  std::vector<Keyframe> path;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Keyframe &a = corners[k], &b = corners[std::min(k + 1, corners.size() - 1)];
    const int steps = std::max(1, static_cast<int>((b.position_mm - a.position_mm).norm() / kStep_mm));
    for (int s = 0; s < (k + 1 < corners.size() ? steps : 1); ++s) {
      Keyframe frame = keyframe_between(a, b, static_cast<double>(s) / steps);
      const auto place = nearest_place(names.design, frame.position_mm);
      if (!place) v.fail("the design has no module");
      frame.position_mm = place->position_mm;
      path.push_back(frame);
      if (path.size() > kMaxKeyframes) v.fail("moves too far; make its way shorter");
    }
  }
  c.to_mm.reset();
  c.keyframes = std::move(path);
}

// A contact that no taxel feels is a mistake in the scene that would otherwise look like a dead skin.
void require_felt(const SceneNames& names, const JsonValue& v, const Contact& c) {
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < names.wiring.size(); ++m) {
    const auto taxels = design::taxels_of(names.design.layout.modules[m], names.wiring[m].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      if (!layout::measures_pressure(t)) continue;
      if (reaches(c, taxels[t].position_mm)) return;
      nearest_mm = std::min(nearest_mm, distance_mm(c, taxels[t].position_mm));
    }
  }
  v.fail(
      fmt::format("no taxel feels this contact: the nearest is {:.1f} mm away, its radius is {:.1f} mm; the "
                  "positions stand in the design file, in mm",
                  nearest_mm, max_radius_mm(c)));
}

}  // namespace

Contact read_contact(const SceneNames& names, const JsonValue& v) {
  only_scene_keys(v, {"at_s", "until_s", "part", "position_mm", "to_mm", "to", "module", "taxel", "nearest_to_mm",
                      "ray", "radius_mm", "force_n", "rise_s", "fall_s", "keyframes", "every_s", "passes", "on_skin"});
  require_part_of_robot(names, v);
  Contact c;
  c.radius_mm = read_radius_mm(v, c.radius_mm);
  c.force_n = read_force_n(v, c.force_n);
  if (has(v, "until_s")) c.until_us = scene_time_us(v["until_s"]);
  if (has(v, "keyframes"))
    read_keyframes(names, v, c);
  else
    read_simple(names, v, c);
  if (c.until_us <= c.from_us) v[has(v, "until_s") ? "until_s" : "keyframes"].fail("must be later than \"at_s\"");
  read_repeats(v, c);
  if (has(v, "on_skin")) keep_on_skin(names, v, c);
  require_felt(names, v, c);
  return c;
}

}  // namespace triskin::hardware
