// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/scene/ad7147.hpp"
#include "triskin/scene/contact.hpp"
#include "triskin/scene/effects.hpp"
#include "triskin/scene/expectation.hpp"
#include "triskin/wire/unique_id.hpp"

namespace triskin::scene {

/// A pressure of the same size everywhere, as of a bag around the skin, at times of the simulation: linear between
/// points, before the first as there, after the last as there.
class PressureCurve {
 public:
  struct Point {
    std::uint64_t at_us = 0;
    double kpa = 0.0;
  };
  /// Nothing presses.
  PressureCurve() = default;
  /// `points`: times do not fall. Of two with one time the later in the list counts from then on.
  explicit PressureCurve(std::vector<Point> points) : points_(std::move(points)) {}
  /// Pressure at a time, kPa. Cost: O(log points).
  [[nodiscard]] double kpa(std::uint64_t at_us) const;
  /// Sets the pressure to `kpa` from `at_us` on and drops later steps; earlier times keep their values.
  void step(std::uint64_t at_us, double kpa);
  [[nodiscard]] bool empty() const { return points_.empty(); }

 private:
  std::vector<Point> points_;
};

/// What is wrong with the simulated hardware (docs/faults_in_scenes.md describes each kind and its keys). A fault is
/// present in [from_us, until_us).
enum class FaultKind {
  kRemovedChip,        ///< module
  kMovedChip,          ///< It has `module`, `line` and `address`, as if straps were soldered wrongly.
  kSwappedChips,       ///< It has `module` and `other`, each of which sits at the other's place.
  kStuckLine,          ///< It has `patch`, `line`, `signal` and `frees_after_pulses`.
  kWrongId,            ///< It has `module` and `value`.
  kLostConfiguration,  ///< module: power dip at from_us, and every_us until until_us
  kSaturatedTaxel,     ///< It has `module` and `taxel`.
  kFrozenTaxel,        ///< It has `module` and `taxel`.
  kFingerElsewhere,    ///< It has `module` and `other`: a finger meant for the first lands on the other.
  kRotatedModule,      ///< It has `module` and `value`: the module is turned by 120° once or twice.
  kDeadModule,         ///< It has `module`, whose logic has no power; this kind and those below need switched modules.
  kHeldLine,           ///< It has `module` and `line`, which the module holds low while its ports are closed.
  kStuckBit,           ///< It has `module`, `bit` and `value` of the register's outputs.
  kModuleReset,        ///< It has `module`, whose register is cleared at from_us.
  kOpenJoint,          ///< It has `module` and `other`.
  kShortedJoint,       ///< It has `module` and `other`.
  kExtraJoint,         ///< It has `module` and `other` of one patch, joined at the first free port of each.
  kSwappedPatches,     ///< It has `patch` and `other`: each controller is plugged into the other's patch.
};
/// Names in scene files (docs/faults_in_scenes.md).
inline constexpr NameTable kFaultKindNames{std::array<std::pair<FaultKind, std::string_view>, 18>{{
    {FaultKind::kRemovedChip, "removed_chip"},
    {FaultKind::kMovedChip, "moved_chip"},
    {FaultKind::kSwappedChips, "swapped_chips"},
    {FaultKind::kStuckLine, "stuck_line"},
    {FaultKind::kWrongId, "wrong_id"},
    {FaultKind::kLostConfiguration, "lost_configuration"},
    {FaultKind::kSaturatedTaxel, "saturated_taxel"},
    {FaultKind::kFrozenTaxel, "frozen_taxel"},
    {FaultKind::kFingerElsewhere, "finger_elsewhere"},
    {FaultKind::kRotatedModule, "rotated_module"},
    {FaultKind::kDeadModule, "dead_module"},
    {FaultKind::kHeldLine, "held_line"},
    {FaultKind::kStuckBit, "stuck_bit"},
    {FaultKind::kModuleReset, "module_reset"},
    {FaultKind::kOpenJoint, "open_joint"},
    {FaultKind::kShortedJoint, "shorted_joint"},
    {FaultKind::kExtraJoint, "extra_joint"},
    {FaultKind::kSwappedPatches, "swapped_patches"},
}}};

struct Fault {
  FaultKind kind = FaultKind::kRemovedChip;
  int module = -1, other = -1, patch = -1, line = -1, address = -1, taxel = -1;
  int value = 0, bit = -1;
  bool stuck_scl = false;
  int frees_after_pulses = 0;
  std::uint64_t from_us = 0, until_us = kForever;
  std::uint64_t every_us = 0;
};
/// True if the fault is present at virtual time `at_us`.
[[nodiscard]] constexpr bool is_present(const Fault& fault, std::uint64_t at_us) {
  return at_us >= fault.from_us && at_us < fault.until_us;
}

/// Physical effects; but for the electrodes each is off, and costs nothing, unless the scene names it.
struct Effects {
  double noise_counts = 0.0;         ///< It is the standard deviation of a sample.
  double drift_counts_per_s = 0.0;   ///< Every taxel drifts by it.
  double taxel_spread_counts = 0.0;  ///< It is half the range of the offset that is added to the electrodes.
  /// It is half the range of the taxels' gains about kCountsPerKpa, as a share of it (< 1).
  double sensitivity_spread = 0.0;
  double electrode_least_pf = 2.0;      ///< It is the smallest capacitance of an electrode; each taxel has its own.
  double electrode_most_pf = 18.0;      ///< It is the largest capacitance of an electrode.
  Ad7147Behaviour converter;            ///< It is the behaviour of every chip and does not occur in scene files.
  std::uint64_t bus_bit_rate = 0;       ///< 0 means that frames take no time.
  std::uint64_t bus_data_bit_rate = 0;  ///< It is the rate of FD frames with a rate switch; 0 means bus_bit_rate.
  double chain_bit_error_rate = 0.0;    ///< It is the probability that a bit on the route chain flips in one module.
  PadEffects pads{};                    ///< They act on the pads (docs/effects.md).
  std::vector<double> clock_ppm{};      ///< Each controller's clock runs faster by this; it is indexed by patch.
};

struct Scene {
  design::Design design;
  /// The controller routes the modules (docs/switched_module.md); if false, they are strapped.
  bool switched = false;
  bool border_joints = false;  ///< Adjacent patches of switched modules are joined at their border, too.
  std::uint64_t seed = 1;
  std::vector<Contact> contacts;
  PressureCurve pressure;  ///< It acts on every taxel in addition to the contacts.
  std::vector<Fault> faults;
  Effects effects;
  std::vector<Expectation> expectations{};  ///< what the skin should report; `simulate --check` holds it against them
  /// Unique id of the controller of each patch; empty: made of the design's id. Where they are given the flash of a
  /// controller is kept under its unique id. Not in scene files.
  std::vector<wire::UniqueId> boards;
  /// Seed of the unique ids if `boards` is empty, beside the design's id, so that the boards do not hang on the bus in
  /// the order of their ids, as on a workbench. Empty: they ascend with the patches. Scene and design files are read
  /// with that of `seed`.
  std::optional<std::uint64_t> board_seed{};
  /// What the electrodes and the noise of each module are drawn from, beside `seed`; empty: its id. Not in scene files.
  std::vector<std::uint64_t> module_seeds;
};

/// Reads a scene file, or a design file (then there are no contacts and no faults). Throws InputError naming
/// file, line and key: wrong types or ranges, unknown keys or kinds, keys that stand twice, a module that the design
/// does not have, times out of order, a contact that no taxel of the skin can feel.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);

/// Unique id of the controller of patch `patch` (0-based) of a scene: of `boards`, else drawn or counted as
/// `board_seed` says. Equal scenes give equal ids. Throws std::out_of_range for a patch that `boards` lacks.
[[nodiscard]] wire::UniqueId unique_id_of(const Scene& scene, std::size_t patch);

/// Number of the hardware of a scene: equal for scenes with the same faults and the same kind of modules.
[[nodiscard]] std::uint64_t hardware_id(const Scene& scene);

/// Rotation 0..2 of a module (id in the design) as assembled: the design's, changed by the faults that are present at
/// virtual time `at_us`. Throws std::out_of_range for a module that the design lacks.
[[nodiscard]] int real_rotation(const Scene& scene, int module, std::uint64_t at_us = 0);

/// Centroid of a module's corners, mesh frame, mm. Throws std::out_of_range for a module that the design lacks.
[[nodiscard]] design::Vec3 center_of(const design::Design& design, int module);

}  // namespace triskin::scene
