// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <random>
#include <string_view>
#include <utility>

#include "scene_reader.hpp"
#include "triskin/base/text_file.hpp"

namespace triskin::scene {
namespace {

using design::has;
using design::JsonValue;
using design::number_in;

void hash_in(std::uint64_t& hash, std::uint64_t value) {
  constexpr std::uint64_t kPrime = 0x100000001B3ULL;
  for (int k = 0; k < 64; k += 8) hash = (hash ^ (value >> k & 0xFF)) * kPrime;
}

// Every bit of the result depends on every bit of `x` (the finalizer of SplitMix64).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ x >> 27) * 0x94D049BB133111EBULL;
  return x ^ x >> 31;
}

void read_electrodes(const JsonValue& v, Effects& e) {
  constexpr double kMax_pf = 30.0;
  v.require_size(2);
  e.electrode_least_pf = number_in(v.at(0), 0.0, kMax_pf);
  e.electrode_most_pf = number_in(v.at(1), e.electrode_least_pf, kMax_pf);
}

Effects read_effects(const JsonValue& v) {
  only_scene_keys(v, {"noise_counts", "drift_counts_per_s", "taxel_spread_counts", "sensitivity_spread", "electrode_pf",
                      "bus_bit_rate", "bus_data_bit_rate", "chain_bit_error_rate", "clock_ppm", "layer", "temperature",
                      "humidity", "crosstalk", "supply", "edges", "emi"});
  Effects e;
  e.pads = read_pad_effects(v);
  if (has(v, "chain_bit_error_rate")) e.chain_bit_error_rate = number_in(v["chain_bit_error_rate"], 0.0, 0.5);
  if (has(v, "clock_ppm")) {
    const JsonValue list = v["clock_ppm"];
    for (std::size_t k = 0; k < list.size(); ++k) e.clock_ppm.push_back(number_in(list.at(k), -5e4, 5e4));
  }
  if (has(v, "noise_counts")) e.noise_counts = number_in(v["noise_counts"], 0.0, 1e4);
  if (has(v, "drift_counts_per_s")) e.drift_counts_per_s = number_in(v["drift_counts_per_s"], -1e4, 1e4);
  if (has(v, "taxel_spread_counts")) e.taxel_spread_counts = number_in(v["taxel_spread_counts"], 0.0, 1e4);
  if (has(v, "sensitivity_spread")) e.sensitivity_spread = number_in(v["sensitivity_spread"], 0.0, 0.9);
  if (has(v, "electrode_pf")) read_electrodes(v["electrode_pf"], e);
  if (has(v, "bus_bit_rate")) e.bus_bit_rate = static_cast<std::uint64_t>(v["bus_bit_rate"].integer(10'000, 1'000'000));
  if (has(v, "bus_data_bit_rate")) {
    e.bus_data_bit_rate = static_cast<std::uint64_t>(v["bus_data_bit_rate"].integer(10'000, 8'000'000));
  }
  return e;
}

PressureCurve read_pressure(const JsonValue& list) {
  constexpr double kMax_kpa = 1e4;
  std::vector<PressureCurve::Point> points;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const JsonValue v = list.at(k);
    only_scene_keys(v, {"at_s", "kpa"});
    points.push_back({scene_time_us(v["at_s"]), number_in(v["kpa"], 0.0, kMax_kpa)});
    if (k > 0 && points[k].at_us < points[k - 1].at_us) v["at_s"].fail("is earlier than the point before");
  }
  return PressureCurve(std::move(points));
}

void read_head(const JsonValue& v) {
  constexpr int kVersion = 1;
  if (v["format"].text() != "triskin-scene") v["format"].fail("must be \"triskin-scene\" (or give a design file)");
  const int version = v["version"].integer(0, 1'000'000);
  if (version != kVersion) v["version"].fail(fmt::format("is {}, this program reads {}", version, kVersion));
  only_scene_keys(v, {"format", "version", "design", "hardware", "border_joints", "seed", "contacts", "pressure",
                      "faults", "effects", "expect"});
}

void require_clocks(const JsonValue& v, const Scene& scene) {
  if (scene.effects.clock_ppm.size() > scene.design.patches.size())
    v["clock_ppm"].fail(fmt::format("has {} clocks, the design has {} controllers", scene.effects.clock_ppm.size(),
                                    scene.design.patches.size()));
}

void read_hardware(const JsonValue& v, Scene& scene) {
  if (has(v, "hardware")) {
    const std::string hardware = v["hardware"].text();
    if (hardware != "switched" && hardware != "strapped") v["hardware"].fail("must be \"strapped\" or \"switched\"");
    scene.switched = hardware == "switched";
  }
  if (has(v, "border_joints")) {
    scene.border_joints = v["border_joints"].boolean();
    if (scene.border_joints && !scene.switched) v["border_joints"].fail("needs \"hardware\": \"switched\"");
  }
}

template <class Item>
void read_list(const JsonValue& v, const char* key, std::vector<Item>& items, const auto& read) {
  if (!has(v, key)) return;
  const JsonValue list = v[key];
  for (std::size_t k = 0; k < list.size(); ++k) items.push_back(read(list.at(k)));
}

}  // namespace

int SceneNames::module(const JsonValue& v) const {
  if (design.layout.modules.empty()) v.fail("the design has none");
  return v.integer(0, static_cast<int>(design.layout.modules.size()) - 1);
}

int SceneNames::patch(const JsonValue& v) const {
  if (design.patches.empty()) v.fail("the design has none");
  return v.integer(0, static_cast<int>(design.patches.size()) - 1);
}

void only_scene_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed) {
  design::only_keys(v, allowed, "docs/scene.md");
}

std::uint64_t scene_time_us(const JsonValue& v) {
  return static_cast<std::uint64_t>(std::llround(number_in(v, 0.0, kMaxScene_s) * 1e6));
}

design::Vec3 scene_point_mm(const JsonValue& v) {
  v.require_size(3);
  const auto at = [&](std::size_t k) { return number_in(v.at(k), -kMaxPlace_mm, kMaxPlace_mm); };
  return {at(0), at(1), at(2)};
}

std::uint64_t hardware_id(const Scene& scene) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;  // The start value is that of FNV-1a.
  hash_in(hash, (scene.switched ? 1U : 0U) | (scene.border_joints ? 2U : 0U));
  for (const Fault& f : scene.faults) {
    for (const int v : {static_cast<int>(f.kind), f.module, f.other, f.patch, f.line, f.address, f.taxel, f.value,
                        f.bit, f.stuck_scl ? 1 : 0, f.frees_after_pulses})
      hash_in(hash, static_cast<std::uint64_t>(static_cast<std::int64_t>(v)));
    for (const std::uint64_t t : {f.from_us, f.until_us, f.every_us}) hash_in(hash, t);
  }
  return hash;
}

int real_rotation(const Scene& scene, int module, std::uint64_t at_us) {
  const auto wiring = design::wiring_of(scene.design);
  const auto designed = [&](int m) { return wiring.at(static_cast<std::size_t>(m)).routed.rotation; };
  int rotation = designed(module);
  for (const Fault& f : scene.faults) {
    if (!is_present(f, at_us)) continue;
    if (f.kind == FaultKind::kRotatedModule && f.module == module) rotation = (rotation + f.value) % 3;
    if (f.kind != FaultKind::kSwappedChips || !scene.switched) continue;
    if (f.module == module) rotation = designed(f.other);
    if (f.other == module) rotation = designed(f.module);
  }
  return rotation;
}

design::Vec3 center_of(const design::Design& design, int module) {
  const auto& corner = design.layout.modules.at(static_cast<std::size_t>(module)).corner_mm;
  return (corner[0] + corner[1] + corner[2]) / 3.0;
}

wire::UniqueId unique_id_of(const Scene& scene, std::size_t patch) {
  if (!scene.boards.empty()) return scene.boards.at(patch);
  const std::uint64_t design_id = scene.design.design_id;
  std::uint64_t high = design_id;
  auto low = static_cast<std::uint32_t>(patch);
  if (scene.board_seed) {
    std::mt19937_64 random(mixed(mixed(design_id ^ *scene.board_seed) + patch));
    high = random();
    low = static_cast<std::uint32_t>(random());
  }
  wire::UniqueId id{};
  for (std::size_t k = 0; k < 8; ++k) id[k] = static_cast<std::uint8_t>(high >> (56 - 8 * k));
  for (std::size_t k = 0; k < 4; ++k) id[8 + k] = static_cast<std::uint8_t>(low >> (24 - 8 * k));
  return id;
}

Scene read_scene(const std::filesystem::path& path) {
  const std::string file = path.string(), text = read_text(path);
  const nlohmann::json document = design::parse_json(text, file);
  const JsonValue v(document, file, "", &text);
  Scene scene;
  if (has(v, "format") && v["format"].raw() == "triskin-design") {
    scene.design = design::read_design(path);
    scene.board_seed = scene.seed;
    return scene;
  }
  read_head(v);
  const std::filesystem::path design = v["design"].text();
  scene.design = design::read_design(design.is_absolute() ? design : path.parent_path() / design);
  if (has(v, "seed")) scene.seed = v["seed"].unsigned_integer();
  scene.board_seed = scene.seed;
  read_hardware(v, scene);
  const SceneNames names(scene);
  read_list(v, "contacts", scene.contacts, [&](const JsonValue& c) { return read_contact(names, c); });
  if (has(v, "pressure")) scene.pressure = read_pressure(v["pressure"]);
  read_list(v, "faults", scene.faults, [&](const JsonValue& f) { return read_fault(names, f); });
  read_list(v, "expect", scene.expectations, [&](const JsonValue& e) { return read_expectation(names, e); });
  if (has(v, "effects")) {
    scene.effects = read_effects(v["effects"]);
    require_clocks(v["effects"], scene);
  }
  return scene;
}

}  // namespace triskin::scene
