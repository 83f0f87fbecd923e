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

#include "triskin/base/format_index.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/hardware/contact.hpp"
#include "triskin/hardware/converters.hpp"
#include "triskin/hardware/effects.hpp"
#include "triskin/hardware/expectation.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/wire/unique_id.hpp"

namespace triskin::hardware {

/// The pressure is equal everywhere, as from a bag around the skin, and a function of simulation time. It is linear
/// between points and constant before the first and after the last.
class PressureCurve {
 public:
  struct Point {
    std::uint64_t at_us = 0;
    double kpa = 0.0;
  };
  /// Makes a curve without any pressure.
  PressureCurve() = default;
  /// The times of `points` must not decrease. Of two points with the same time, the later in the list applies from then
  /// on.
  explicit PressureCurve(std::vector<Point> points) : points_(std::move(points)) {}
  /// Returns the pressure at a time in kPa. Cost: O(log points).
  [[nodiscard]] double kpa(std::uint64_t at_us) const;
  /// Sets the pressure to `kpa` from `at_us` on and drops later steps; earlier times keep their values.
  void step(std::uint64_t at_us, double kpa);
  [[nodiscard]] bool empty() const { return points_.empty(); }

 private:
  std::vector<Point> points_;
};

/// The simulated hardware can have these faults (docs/scene.md describes each kind and its keys). A fault is
/// present in [from_us, until_us).
enum class FaultKind {
  kRemovedChip,        ///< The key is `module`.
  kMovedChip,          ///< The keys are `module`, `line` and `address`; the straps seem to be soldered wrongly.
  kSwappedChips,       ///< The keys are `module` and `other`, each of which is at the other's place.
  kStuckLine,          ///< The keys are `patch`, `line`, `signal` and `frees_after_pulses`.
  kWrongId,            ///< The keys are `module` and `value`.
  kLostConfiguration,  ///< The key is `module`; its power dips at from_us, and again every every_us until until_us.
  kSaturatedTaxel,     ///< The keys are `module` and `taxel`.
  kFrozenTaxel,        ///< The keys are `module` and `taxel`.
  kFingerElsewhere,    ///< The keys are `module` and `other`: a finger meant for the first lands on the other.
  kRotatedModule,      ///< The keys are `module` and `value`: the module is turned by 120° once or twice.
  kOpenLine,           ///< The keys are `module` and `line`, whose wires are open at the module's joint to its parent.
  kLoosePlug,          ///< The key is `module`: it and all behind it have no wires, and no supply.
  kDriftingChip,       ///< The keys are `module` and `value`: all its taxels gain so many counts a second.
  kOtherFirmware,      ///< The keys are `patch` and `value`: its controller speaks this wire version.
  kSameNumber,         ///< The keys are `patch` and `other`: its controller gets the node address of the other one.
  kDeadModule,      ///< The key is `module`, whose logic has no power; this kind and those below need switched modules.
  kHeldLine,        ///< The keys are `module` and `line`, which the module holds low while its ports are closed.
  kStuckBit,        ///< The keys are `module`, `bit` and `value` of the register's outputs.
  kModuleReset,     ///< The key is `module`, whose register is cleared at from_us.
  kOpenJoint,       ///< The keys are `module` and `other`.
  kShortedJoint,    ///< The keys are `module` and `other`.
  kExtraJoint,      ///< The keys are `module` and `other` of one patch, joined at the first free port of each.
  kSwappedPatches,  ///< The keys are `patch` and `other`: each controller is plugged into the other's patch.
};
/// Scene files use these names (docs/scene.md).
inline constexpr NameTable kFaultKindNames{std::array<std::pair<FaultKind, std::string_view>, 23>{{
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
    {FaultKind::kOpenLine, "open_line"},
    {FaultKind::kLoosePlug, "loose_plug"},
    {FaultKind::kDriftingChip, "drifting_chip"},
    {FaultKind::kOtherFirmware, "other_firmware"},
    {FaultKind::kSameNumber, "same_number"},
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
  layout::ModuleId module = layout::ModuleId::none(), other = layout::ModuleId::none();
  layout::PatchIndex patch = layout::PatchIndex::none();
  /// Scene files call this patch `other` as well; only kSwappedPatches and kSameNumber have it.
  layout::PatchIndex other_patch = layout::PatchIndex::none();
  int line = -1, address = -1;
  layout::TaxelIndex taxel = layout::TaxelIndex::none();
  int value = 0, bit = -1;
  bool stuck_scl = false;
  int frees_after_pulses = 0;
  std::uint64_t from_us = 0, until_us = kForever;
  std::uint64_t every_us = 0;
};
/// Returns true if the fault is present at virtual time `at_us`.
[[nodiscard]] constexpr bool is_present(const Fault& fault, std::uint64_t at_us) {
  return at_us >= fault.from_us && at_us < fault.until_us;
}

/// A scene can have these physical effects. Except for the electrodes, each is off and costs nothing unless the scene
/// names it.
struct Effects {
  double noise_counts = 0.0;         ///< The noise of a sample has this standard deviation.
  double drift_counts_per_s = 0.0;   ///< Every taxel drifts at this rate.
  double taxel_spread_counts = 0.0;  ///< The offset that is added to an electrode lies within ± this value.
  /// The gains of the taxels lie within ± this fraction of kCountsPerKpa (< 1).
  double sensitivity_spread = 0.0;
  /// Each taxel's electrode is drawn from this range: from what a temperature pad of our board has at least to what
  /// installed boards have at most (docs/silicon.md, "What electrodes have").
  double electrode_least_pf = 0.15, electrode_most_pf = 15.0;
  double bus_coupling_counts = 0.0;     ///< Ad7147Behaviour::bus_coupling_counts of every chip
  Converters converters{};              ///< Scene files have it beside "effects".
  std::uint64_t bus_bit_rate = 0;       ///< 0 means that frames take no time.
  std::uint64_t bus_data_bit_rate = 0;  ///< It is the rate of FD frames with a rate switch; 0 means bus_bit_rate.
  double chain_bit_error_rate = 0.0;    ///< It is the probability that a bit on the route chain flips in one module.
  PadEffects pads{};                    ///< The effects act on the pads (docs/simulation.md).
  std::vector<double> clock_ppm{};      ///< Each controller's clock runs faster by this; it is indexed by patch.
};

/// A controller can be simulated at these levels (docs/simulation.md).
enum class ControllerLevel {
  kFirmware,  ///< The firmware runs and reaches the chips by I²C transfers.
  kTable,     ///< While nothing happens but streaming, the controller's table and its chips give the samples.
};
/// Scene files use these names.
inline constexpr NameTable kControllerLevelNames{std::array<std::pair<ControllerLevel, std::string_view>, 2>{{
    {ControllerLevel::kFirmware, "firmware"},
    {ControllerLevel::kTable, "table"},
}}};

struct Scene {
  design::Design design;
  /// The controller routes the modules (docs/switched_module.md); if false, they are strapped.
  bool switched = false;
  bool border_joints = false;  ///< Adjacent patches of switched modules are also joined at their border.
  std::uint64_t seed = 1;
  std::vector<Contact> contacts;
  PressureCurve pressure;  ///< The pressure acts on every taxel in addition to the contacts.
  std::vector<Fault> faults;
  Effects effects;
  /// Levels are indexed by patch; controllers beyond the list run their firmware.
  std::vector<ControllerLevel> levels{};
  std::vector<Expectation> expectations{};  ///< `simulate --check` compares the reports of the skin with these.
  /// The controller of each patch has its unique id here; if the list is empty, ids are derived from the design's id.
  /// With given ids, the flash of a controller is stored under its id. Scene files cannot set this.
  std::vector<wire::UniqueId> boards;
  /// If `boards` is empty, this seed and the design's id determine the unique ids, so that the order of the boards on
  /// the bus differs from that of their ids, as on a workbench. If it is empty too, the ids ascend with the patches.
  /// Scene and design files are read with `seed` as its value.
  std::optional<std::uint64_t> board_seed{};
  /// Besides `seed`, these values determine the random electrodes and noise of each module; if the list is empty, its
  /// id does. Scene files cannot set this.
  std::vector<std::uint64_t> module_seeds;
};

/// Reads a scene file, or a design file (then there are no contacts and no faults). Throws InputError naming file, line
/// and key: wrong types or ranges, unknown keys or kinds, repeated keys, a module that the design does not have, times
/// out of order, a contact that no taxel of the skin can feel.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);

/// Returns the unique id of the controller of patch `patch` (0-based) of a scene: from `boards`, or else as
/// `board_seed` says. Equal scenes give equal ids. Throws std::out_of_range for a patch that `boards` lacks.
[[nodiscard]] wire::UniqueId unique_id_of(const Scene& scene, layout::PatchIndex patch);

/// Returns a number that is equal for scenes with the same faults and the same kind of modules.
[[nodiscard]] std::uint64_t hardware_id(const Scene& scene);

/// Returns the rotation 0..2 of a module (id in the design) as assembled: the design's, changed by the faults that are
/// present at virtual time `at_us`. Throws std::out_of_range for a module that the design lacks.
[[nodiscard]] int real_rotation(const Scene& scene, layout::ModuleId module, std::uint64_t at_us = 0);

/// Returns the centroid of a module's corners in the mesh frame, mm. Throws std::out_of_range for a module that the
/// design lacks.
[[nodiscard]] design::Vec3 center_of(const design::Design& design, layout::ModuleId module);

}  // namespace triskin::hardware
