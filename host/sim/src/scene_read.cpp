// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <string_view>
#include <utility>

#include "triskin/base/files.hpp"
#include "triskin/design/json_fields.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/scene/scene.hpp"

namespace triskin::scene {
namespace {

using design::JsonValue;
using design::number_in;

constexpr double kMaxSeconds = 1e6;
constexpr double kMaxLength_mm = 1e5;

bool needs_switched(FaultKind kind) {
  return kind >= FaultKind::kDeadModule;
}

void only_keys(const JsonValue& v, std::initializer_list<std::string_view> allowed) {
  design::only_keys(v, allowed, "docs/scene.md");
}

std::uint64_t time_us(const JsonValue& v) {
  return static_cast<std::uint64_t>(std::llround(number_in(v, 0.0, kMaxSeconds) * 1e6));
}

design::Vec3 point(const JsonValue& v) {
  v.require_size(3);
  const auto at = [&](std::size_t k) { return number_in(v.at(k), -kMaxLength_mm, kMaxLength_mm); };
  return {at(0), at(1), at(2)};
}

class Reader {
 public:
  explicit Reader(const Scene& scene)
      : design_(scene.design), switched_(scene.switched), wiring_(design::wiring_of(scene.design)) {}

  [[nodiscard]] int module(const JsonValue& v) const { return below(v, design_.layout.modules.size()); }

  [[nodiscard]] Contact contact(const JsonValue& v) const {
    only_keys(v, {"at_s", "until_s", "position_mm", "to_mm", "module", "taxel", "radius_mm", "force_n"});
    Contact c;
    if (has(v, "at_s")) c.from_us = time_us(v["at_s"]);
    if (has(v, "until_s")) c.until_us = time_us(v["until_s"]);
    if (c.until_us <= c.from_us) v["until_s"].fail("must be later than \"at_s\"");
    if (has(v, "position_mm") == has(v, "module")) v.fail("needs either \"position_mm\" or \"module\"");
    c.position_mm = has(v, "module") ? on_module(v) : point(v["position_mm"]);
    if (has(v, "to_mm")) c.to_mm = point(v["to_mm"]);
    if (c.to_mm && c.until_us == kForever) v["to_mm"].fail("needs \"until_s\": the time at which it arrives");
    if (has(v, "radius_mm")) c.radius_mm = number_in(v["radius_mm"], 0.1, 1000.0);
    if (has(v, "force_n")) c.force_n = number_in(v["force_n"], 0.0, 1000.0);
    require_felt(v, c);
    return c;
  }

  [[nodiscard]] Fault fault(const JsonValue& v) const {
    Fault f;
    const JsonValue kind = v["kind"];
    const std::string text = kind.text();
    const auto known = kFaultKindNames.value(text);
    if (!known) kind.fail("\"" + text + "\" is no kind of fault; docs/scene.md lists them");
    f.kind = *known;
    if (needs_switched(f.kind) && !switched_)
      kind.fail("\"" + text + "\" needs \"hardware\": \"switched\" in the scene");
    if (f.kind == FaultKind::kMovedChip && switched_)
      kind.fail("\"moved_chip\" is a fault of straps; switched modules have none");
    if (f.kind >= FaultKind::kRotatedModule)
      read_switched_keys(v, f);
    else
      read_keys(v, f);
    return f;
  }

 private:
  static int below(const JsonValue& v, std::size_t n) {
    if (n == 0) v.fail("the design has none");
    return v.integer(0, static_cast<int>(n) - 1);
  }

  [[nodiscard]] design::Vec3 on_module(const JsonValue& v) const {
    const int m = module(v["module"]);
    if (!has(v, "taxel")) return center_of(design_, m);
    const auto k = static_cast<std::size_t>(m);
    const auto taxels = design::taxels_of(design_.layout.modules[k], wiring_[k].routed.rotation);
    return taxels[static_cast<std::size_t>(v["taxel"].integer(0, 11))].position_mm;
  }

  // A contact that no taxel feels is a mistake in the scene, which would otherwise look like a dead skin.
  void require_felt(const JsonValue& v, const Contact& c) const {
    if (has(v, "taxel") && !layout::measures_pressure(static_cast<std::size_t>(v["taxel"].raw().get<int>())))
      v["taxel"].fail(fmt::format("pad {} measures temperature and feels no finger; choose another taxel",
                                  v["taxel"].raw().get<int>()));
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < wiring_.size(); ++m) {
      const auto taxels = design::taxels_of(design_.layout.modules[m], wiring_[m].routed.rotation);
      for (std::size_t t = 0; t < taxels.size(); ++t) {
        if (layout::measures_pressure(t)) nearest_mm = std::min(nearest_mm, distance_mm(c, taxels[t].position_mm));
      }
    }
    if (nearest_mm >= c.radius_mm)
      v.fail(
          fmt::format("no taxel feels this contact: the nearest is {:.1f} mm away, its radius is {:.1f} mm; the "
                      "positions stand in the design file, in mm",
                      nearest_mm, c.radius_mm));
  }

  void read_keys(const JsonValue& v, Fault& f) const {
    switch (f.kind) {
      case FaultKind::kRemovedChip:
        only_keys(v, {"kind", "module", "at_s", "until_s"});
        if (has(v, "at_s")) f.from_us = time_us(v["at_s"]);
        if (has(v, "until_s")) f.until_us = time_us(v["until_s"]);
        if (f.until_us <= f.from_us) v["until_s"].fail("must be later than \"at_s\"");
        break;
      case FaultKind::kMovedChip:
        only_keys(v, {"kind", "module", "line", "address"});
        f.line = v["line"].integer(0, 3);
        f.address = v["address"].integer(0, 3);
        break;
      case FaultKind::kSwappedChips:
      case FaultKind::kFingerElsewhere:
        only_keys(v, {"kind", "module", "other"});
        f.other = module(v["other"]);
        break;
      case FaultKind::kStuckLine:
        return read_stuck_line(v, f);
      case FaultKind::kWrongId:
        only_keys(v, {"kind", "module", "value"});
        f.value = has(v, "value") ? v["value"].integer(0, 0xFFFF) : 0xFFFF;
        break;
      case FaultKind::kLostConfiguration:
        only_keys(v, {"kind", "module", "at_s", "every_s"});
        f.from_us = has(v, "at_s") ? time_us(v["at_s"]) : 1'000'000;
        if (has(v, "every_s"))
          f.every_us = static_cast<std::uint64_t>(number_in(v["every_s"], 1e-3, kMaxSeconds) * 1e6);
        break;
      case FaultKind::kSaturatedTaxel:
      case FaultKind::kFrozenTaxel:
        only_keys(v, {"kind", "module", "taxel"});
        f.taxel = v["taxel"].integer(0, 11);
        break;
      default:
        break;
    }
    f.module = module(v["module"]);
    if (f.other == f.module) v["other"].fail("must be another module");
  }

  void read_switched_keys(const JsonValue& v, Fault& f) const {
    if (f.kind == FaultKind::kSwappedPatches) {
      only_keys(v, {"kind", "patch", "other"});
      f.patch = below(v["patch"], design_.patches.size());
      f.other = below(v["other"], design_.patches.size());
      if (f.other == f.patch) v["other"].fail("must be another patch");
      return;
    }
    only_keys(v, {"kind", "module", "other", "line", "bit", "value", "steps", "at_s", "until_s"});
    f.module = module(v["module"]);
    if (f.kind == FaultKind::kRotatedModule) f.value = has(v, "steps") ? v["steps"].integer(1, 2) : 1;
    if (f.kind == FaultKind::kHeldLine) f.line = v["line"].integer(0, 3);
    if (f.kind == FaultKind::kStuckBit) {
      f.bit = v["bit"].integer(0, 7);
      f.value = v["value"].integer(0, 1);
    }
    if (f.kind == FaultKind::kOpenJoint || f.kind == FaultKind::kShortedJoint || f.kind == FaultKind::kExtraJoint) {
      f.other = module(v["other"]);
      if (f.other == f.module) v["other"].fail("must be another module");
      const bool neighbours = std::ranges::count(design::joined_to(design_.layout, f.module), f.other) > 0;
      if (!neighbours && f.kind != FaultKind::kExtraJoint) v["other"].fail("has no joint with \"module\"");
    }
    if (has(v, "at_s")) f.from_us = time_us(v["at_s"]);
    if (has(v, "until_s")) f.until_us = time_us(v["until_s"]);
    if (f.until_us <= f.from_us) v["until_s"].fail("must be later than \"at_s\"");
  }

  void read_stuck_line(const JsonValue& v, Fault& f) const {
    only_keys(v, {"kind", "patch", "line", "signal", "at_s", "frees_after_pulses"});
    f.patch = below(v["patch"], design_.patches.size());
    f.line = v["line"].integer(0, 3);
    if (has(v, "signal")) {
      const std::string signal = v["signal"].text();
      if (signal != "sda" && signal != "scl") v["signal"].fail("must be \"sda\" or \"scl\"");
      f.stuck_scl = signal == "scl";
    }
    if (has(v, "at_s")) f.from_us = time_us(v["at_s"]);
    if (has(v, "frees_after_pulses")) f.frees_after_pulses = v["frees_after_pulses"].integer(0, 1000);
  }

  const design::Design& design_;
  bool switched_;
  std::vector<design::ModuleWiring> wiring_;
};

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
  constexpr double kMost_pf = 30.0;
  v.require_size(2);
  e.electrode_least_pf = number_in(v.at(0), 0.0, kMost_pf);
  e.electrode_most_pf = number_in(v.at(1), e.electrode_least_pf, kMost_pf);
}

Effects read_effects(const JsonValue& v) {
  only_keys(v, {"noise_counts", "drift_counts_per_s", "taxel_spread_counts", "sensitivity_spread", "electrode_pf",
                "bus_bit_rate", "bus_data_bit_rate", "chain_bit_error_rate", "clock_ppm"});
  Effects e;
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
  constexpr double kMost_kpa = 1e4;
  std::vector<PressureCurve::Point> points;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const JsonValue v = list.at(k);
    only_keys(v, {"at_s", "kpa"});
    points.push_back({time_us(v["at_s"]), number_in(v["kpa"], 0.0, kMost_kpa)});
    if (k > 0 && points[k].at_us < points[k - 1].at_us) v["at_s"].fail("is earlier than the point before");
  }
  return PressureCurve(std::move(points));
}

void read_head(const JsonValue& v) {
  constexpr int kVersion = 1;
  if (v["format"].text() != "triskin-scene") v["format"].fail("must be \"triskin-scene\" (or give a design file)");
  const int version = v["version"].integer(0, 1'000'000);
  if (version != kVersion) v["version"].fail(fmt::format("is {}, this program reads {}", version, kVersion));
  only_keys(v, {"format", "version", "design", "hardware", "border_joints", "seed", "contacts", "pressure", "faults",
                "effects"});
}

}  // namespace

std::uint64_t hardware_id(const Scene& scene) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;  // FNV-1a
  hash_in(hash, (scene.switched ? 1U : 0U) | (scene.border_joints ? 2U : 0U));
  for (const Fault& f : scene.faults) {
    for (const int v : {static_cast<int>(f.kind), f.module, f.other, f.patch, f.line, f.address, f.taxel, f.value,
                        f.bit, f.stuck_scl ? 1 : 0, f.frees_after_pulses})
      hash_in(hash, static_cast<std::uint64_t>(static_cast<std::int64_t>(v)));
    for (const std::uint64_t t : {f.from_us, f.until_us, f.every_us}) hash_in(hash, t);
  }
  return hash;
}

double distance_mm(const Contact& contact, const design::Vec3& point_mm) {
  design::Vec3 nearest = contact.position_mm;
  if (contact.to_mm) {
    const design::Vec3 path = *contact.to_mm - contact.position_mm;
    const double length2 = path.squaredNorm();
    if (length2 > 0.0) nearest += path * std::clamp((point_mm - contact.position_mm).dot(path) / length2, 0.0, 1.0);
  }
  return (point_mm - nearest).norm();
}

int real_rotation(const Scene& scene, int module) {
  const auto wiring = design::wiring_of(scene.design);
  const auto designed = [&](int m) { return wiring.at(static_cast<std::size_t>(m)).routed.rotation; };
  int rotation = designed(module);
  for (const Fault& f : scene.faults) {
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
  const std::string file = path.string();
  const nlohmann::json document = design::parse_json(read_file(path), file);
  const JsonValue v(document, file, "");
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
  if (has(v, "hardware")) {
    const std::string hardware = v["hardware"].text();
    if (hardware != "switched" && hardware != "strapped") v["hardware"].fail("must be \"strapped\" or \"switched\"");
    scene.switched = hardware == "switched";
  }
  if (has(v, "border_joints")) {
    scene.border_joints = v["border_joints"].boolean();
    if (scene.border_joints && !scene.switched) v["border_joints"].fail("needs \"hardware\": \"switched\"");
  }
  const Reader reader(scene);
  if (has(v, "contacts")) {
    const JsonValue list = v["contacts"];
    for (std::size_t k = 0; k < list.size(); ++k) scene.contacts.push_back(reader.contact(list.at(k)));
  }
  if (has(v, "pressure")) scene.pressure = read_pressure(v["pressure"]);
  if (has(v, "faults")) {
    const JsonValue list = v["faults"];
    for (std::size_t k = 0; k < list.size(); ++k) scene.faults.push_back(reader.fault(list.at(k)));
  }
  if (has(v, "effects")) scene.effects = read_effects(v["effects"]);
  return scene;
}

}  // namespace triskin::scene
