// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>
#include <utility>

#include "scene_reader.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/design/file_head.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/hardware/robot_scene.hpp"

namespace triskin::hardware {
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

std::uint64_t read_bit_rate(const JsonValue& v, int max) {
  return static_cast<std::uint64_t>(v.integer(10'000, max));
}

Effects read_effects(const JsonValue& v) {
  only_scene_keys(v, {"noise_counts", "drift_counts_per_s", "taxel_spread_counts", "sensitivity_spread", "electrode_pf",
                      "bus_bit_rate", "bus_data_bit_rate", "chain_bit_error_rate", "clock_ppm", "layer", "temperature",
                      "humidity", "crosstalk", "supply", "edges", "emi", "bus_coupling_counts"});
  Effects e;
  e.pads = read_pad_effects(v);
  if (has(v, "chain_bit_error_rate")) e.chain_bit_error_rate = number_in(v["chain_bit_error_rate"], 0.0, 0.5);
  if (has(v, "noise_counts")) e.noise_counts = number_in(v["noise_counts"], 0.0, 1e4);
  if (has(v, "drift_counts_per_s")) e.drift_counts_per_s = number_in(v["drift_counts_per_s"], -1e4, 1e4);
  if (has(v, "taxel_spread_counts")) e.taxel_spread_counts = number_in(v["taxel_spread_counts"], 0.0, 1e4);
  if (has(v, "sensitivity_spread")) e.sensitivity_spread = number_in(v["sensitivity_spread"], 0.0, 0.9);
  if (has(v, "bus_coupling_counts")) e.bus_coupling_counts = number_in(v["bus_coupling_counts"], 0.0, 1e4);
  if (has(v, "electrode_pf")) read_electrodes(v["electrode_pf"], e);
  if (has(v, "bus_bit_rate")) e.bus_bit_rate = read_bit_rate(v["bus_bit_rate"], 1'000'000);
  if (has(v, "bus_data_bit_rate")) e.bus_data_bit_rate = read_bit_rate(v["bus_data_bit_rate"], 8'000'000);
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
  design::require_head(v, "triskin-scene", kVersion, "docs/scene.md describes it");
  only_scene_keys(v, {"format", "version", "design", "robot", "hardware", "border_joints", "seed", "contacts",
                      "controllers", "converters", "pressure", "faults", "effects", "expect"});
  if (has(v, "design") == has(v, "robot")) v.fail("needs either \"design\" or \"robot\": the file that it simulates");
}

void read_clocks(const JsonValue& list, Scene& scene) {
  std::vector<double>& clock_ppm = scene.effects.clock_ppm;
  for (std::size_t k = 0; k < list.size(); ++k) clock_ppm.push_back(number_in(list.at(k), -5e4, 5e4));
  if (clock_ppm.size() > scene.design.patches.size())
    list.fail(
        fmt::format("has {} clocks, the design has {} controllers", clock_ppm.size(), scene.design.patches.size()));
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

void each_item(const JsonValue& v, const char* key, const auto& read) {
  if (!has(v, key)) return;
  const JsonValue list = v[key];
  for (std::size_t k = 0; k < list.size(); ++k) read(list.at(k));
}

// Reads what does not depend on the design.
Scene read_surroundings(const JsonValue& v) {
  Scene scene;
  if (has(v, "seed")) scene.seed = v["seed"].unsigned_integer();
  scene.board_seed = scene.seed;
  read_hardware(v, scene);
  if (has(v, "pressure")) scene.pressure = read_pressure(v["pressure"]);
  if (has(v, "effects")) scene.effects = read_effects(v["effects"]);
  if (has(v, "converters")) scene.effects.converters = read_converters(v["converters"]);
  return scene;
}

// Reads the level of one controller, or of all of them.
void read_controller(const SceneNames& names, const JsonValue& v, Scene& scene) {
  only_scene_keys(v, {"part", "patch", "level"});
  require_part_of_robot(names, v);
  const auto level = kControllerLevelNames.value(v["level"].text());
  if (!level) v["level"].fail("is not a level of a controller; give " + kControllerLevelNames.list());
  if (*level == ControllerLevel::kTable && names.switched)
    v["level"].fail("of switched modules must be \"firmware\", which routes them; the table does not know their chain");
  scene.levels.resize(scene.design.patches.size(), ControllerLevel::kFirmware);
  const std::size_t first = has(v, "patch") ? static_cast<std::size_t>(names.patch(v["patch"])) : 0;
  const std::size_t end = has(v, "patch") ? first + 1 : scene.levels.size();
  for (std::size_t p = first; p < end; ++p) scene.levels[p] = *level;
}

// The table continues the sequences of the chips in virtual time.
void require_common_time(const JsonValue& v, const Scene& scene) {
  const std::size_t clocks = std::min(scene.effects.clock_ppm.size(), scene.levels.size());
  for (std::size_t p = 0; p < clocks; ++p) {
    if (scene.levels[p] == ControllerLevel::kTable)
      v["clock_ppm"].fail(
          fmt::format("controller {} is simulated by its table, which has virtual time; a clock of its "
                      "own needs level \"firmware\"",
                      p));
  }
}

std::filesystem::path beside(const std::filesystem::path& scene, const JsonValue& v) {
  const std::filesystem::path file = v.text();
  return file.is_absolute() ? file : scene.parent_path() / file;
}

bool is_of_robot(const JsonValue& v) {
  return has(v, "format") && v["format"].raw() == "triskin-scene" && has(v, "robot");
}

// Finds the parts of a robot by their names.
class PartNames {
 public:
  PartNames(const std::vector<std::string>& names, const std::vector<Scene>& parts) : names_(names) {
    for (std::size_t p = 0; p < parts.size(); ++p) of_.emplace_back(parts[p], names[p]);
  }
  [[nodiscard]] std::size_t index(const JsonValue& v) const {
    if (!v.raw().is_object()) v.fail("must be an object");
    if (!has(v, "part")) v.fail(fmt::format("needs \"part\": {}", fmt::join(names_, ", ")));
    return index_of(v["part"], v["part"].text());
  }
  [[nodiscard]] std::size_t index_of(const JsonValue& v, const std::string& name) const {
    const auto found = std::ranges::find(names_, name);
    if (found == names_.end())
      v.fail(fmt::format("\"{}\" is not a part of the robot; it has {}", name, fmt::join(names_, ", ")));
    return static_cast<std::size_t>(found - names_.begin());
  }
  [[nodiscard]] const SceneNames& operator[](std::size_t part) const { return of_[part]; }

 private:
  const std::vector<std::string>& names_;
  std::vector<SceneNames> of_;
};

// An expectation without a part and without a module is one of the whole robot.
Expectation read_expectation_of(const PartNames& parts, const JsonValue& v) {
  if (v.raw().is_object() && (has(v, "part") || has(v, "module"))) return read_expectation(parts[parts.index(v)], v);
  Expectation e = read_expectation(parts[0], v);
  e.part.clear();
  return e;
}

void read_clocks_of(const JsonValue& v, const PartNames& names, RobotScene& scene) {
  if (!v.raw().is_object()) v.fail("must be an object with a list for each part, such as {\"torso\": [20, -30]}");
  for (const auto& [name, list] : v.raw().items()) read_clocks(v[name.c_str()], scene.parts[names.index_of(v, name)]);
}

}  // namespace

layout::ModuleId SceneNames::module(const JsonValue& v) const {
  if (design.layout.modules.empty()) v.fail("the design has none");
  if (design.layout.numbers.empty())
    return layout::ModuleId{v.integer(0, static_cast<int>(design.layout.modules.size()) - 1)};
  const layout::ModuleId module = design::module_with(design, {v.integer(0, design::kMaxModuleNumber)});
  if (module < 0) v.fail("is no module of the design; it has " + design::ranges_text(design.layout.numbers));
  return module;
}

layout::PatchIndex SceneNames::patch(const JsonValue& v) const {
  if (design.patches.empty()) v.fail("the design has none");
  const layout::PatchIndex patch{v.integer(0, static_cast<int>(design.patches.size()) - 1)};
  if (!design::has_patch(design, patch)) v.fail("must be one of " + design::patch_numbers(design));
  return patch;
}

void only_scene_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed) {
  design::only_keys(v, allowed, "docs/scene.md");
}

void require_part_of_robot(const SceneNames& names, const JsonValue& v) {
  if (names.part.empty() && has(v, "part"))
    v["part"].fail("belongs to the scene of a robot, which names \"robot\" in place of \"design\"; leave it out");
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
    const int other = f.other_patch >= 0 ? f.other_patch.value() : f.other.value();
    for (const int v : {static_cast<int>(f.kind), f.module.value(), other, f.patch.value(), f.line, f.address,
                        f.taxel.value(), f.value, f.bit, f.stuck_scl ? 1 : 0, f.frees_after_pulses})
      hash_in(hash, static_cast<std::uint64_t>(static_cast<std::int64_t>(v)));
    for (const std::uint64_t t : {f.from_us, f.until_us, f.every_us}) hash_in(hash, t);
  }
  return hash;
}

int real_rotation(const Scene& scene, layout::ModuleId module, std::uint64_t at_us) {
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

design::Vec3 center_of(const design::Design& design, layout::ModuleId module) {
  const auto& corner = design.layout.modules.at(static_cast<std::size_t>(module)).corner_mm;
  return (corner[0] + corner[1] + corner[2]) / 3.0;
}

wire::UniqueId unique_id_of(const Scene& scene, layout::PatchIndex patch_index) {
  const auto patch = static_cast<std::size_t>(patch_index);
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

namespace {

Scene scene_of_design(const std::filesystem::path& path) {
  Scene scene;
  scene.design = design::read_design(path);
  scene.board_seed = scene.seed;
  return scene;
}

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
  const std::string file = path.string(), text = read_text(path);
  const nlohmann::json document = design::parse_json(text, file);
  const JsonValue v(document, file);
  if (has(v, "format") && v["format"].raw() == "triskin-design") return scene_of_design(path);
  read_head(v);
  if (has(v, "robot")) v["robot"].fail("is a scene of a robot; give its robot file in place of the design");
  Scene scene = read_surroundings(v);
  scene.design = design::read_design(beside(path, v["design"]));
  const SceneNames names(scene);
  each_item(v, "contacts", [&](const JsonValue& c) { scene.contacts.push_back(read_contact(names, c)); });
  each_item(v, "faults", [&](const JsonValue& f) { scene.faults.push_back(read_fault(names, f)); });
  each_item(v, "expect", [&](const JsonValue& e) { scene.expectations.push_back(read_expectation(names, e)); });
  each_item(v, "controllers", [&](const JsonValue& c) { read_controller(names, c, scene); });
  if (!has(v, "effects") || !has(v["effects"], "clock_ppm")) return scene;
  read_clocks(v["effects"]["clock_ppm"], scene);
  require_common_time(v["effects"], scene);
  return scene;
}

bool is_robot_scene(const std::filesystem::path& path) {
  const std::string file = path.string(), text = read_text(path);
  const nlohmann::json document = design::parse_json(text, file);
  return document.is_object() && is_of_robot(JsonValue(document, file));
}

namespace {

void read_items(const JsonValue& v, const PartNames& names, RobotScene& scene) {
  each_item(v, "contacts", [&](const JsonValue& c) {
    const std::size_t p = names.index(c);
    scene.parts[p].contacts.push_back(read_contact(names[p], c));
  });
  each_item(v, "faults", [&](const JsonValue& f) {
    const std::size_t p = names.index(f);
    scene.parts[p].faults.push_back(read_fault(names[p], f));
  });
  each_item(v, "expect", [&](const JsonValue& e) { scene.expectations.push_back(read_expectation_of(names, e)); });
  each_item(v, "controllers", [&](const JsonValue& c) {
    const std::size_t p = names.index(c);
    read_controller(names[p], c, scene.parts[p]);
  });
}

void read_effects_of_parts(const JsonValue& v, const PartNames& names, RobotScene& scene) {
  for (const char* key : {"bus_bit_rate", "bus_data_bit_rate"})
    if (has(v, key)) v[key].fail("stands in the robot file, at each bus; leave it out");
  if (has(v, "clock_ppm")) read_clocks_of(v["clock_ppm"], names, scene);
  for (const Scene& part : scene.parts) require_common_time(v, part);
}

}  // namespace

RobotScene read_robot_scene(const std::filesystem::path& path,
                            const std::function<std::vector<RobotPart>(const std::filesystem::path&)>& parts_of) {
  const std::string file = path.string(), text = read_text(path);
  const nlohmann::json document = design::parse_json(text, file);
  const JsonValue v(document, file);
  read_head(v);
  if (!has(v, "robot")) v["design"].fail("is a scene of one design; a robot needs \"robot\" with its robot file here");
  RobotScene scene;
  scene.file = path;
  scene.robot = beside(path, v["robot"]);
  const Scene surroundings = read_surroundings(v);
  for (RobotPart& part : parts_of(scene.robot)) {
    scene.names.push_back(std::move(part.name));
    scene.parts.push_back(surroundings);
    scene.parts.back().design = std::move(part.design);
  }
  if (scene.parts.empty()) v["robot"].fail("has no parts; add one with triskin robot add");
  const PartNames names(scene.names, scene.parts);
  read_items(v, names, scene);
  if (has(v, "effects")) read_effects_of_parts(v["effects"], names, scene);
  return scene;
}

}  // namespace triskin::hardware
