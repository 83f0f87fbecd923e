// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>
#include <utility>

#include "triskin/base/names.hpp"

namespace triskin::diagnose {

/// Hardware and design can differ in these ways. The first group concerns controllers and their tables, the second the
/// values that controllers read, the third the modules and joints that the route chain shows (docs/diagnose.md,
/// docs/switched_module.md).
enum class FindingKind {
  kAbsentController,     ///< No controller answers at the node address of the patch.
  kDuplicateController,  ///< Several controllers share the node address.
  kNotFlashed,           ///< No controller has the table of the patch, and some have no table of any design.
  kWrongTable,           ///< The controller has another table.
  kWrongKind,            ///< The controller's table has the modules of the design, but this one has another kind.
  kBackupRoute,          ///< The controller has the table that the design prepared for a failure.
  kLostSamples,          ///< Samples of the stream did not arrive.
  kCrashedController,    ///< A fault, the watchdog or the clock stopped the controller.
  kWrongFirmware,        ///< The controller speaks another version of the protocol.
  kWrongPatch,           ///< The controller's cable leads to the modules of another patch.

  kAbsentModule,        ///< No chip answers at the module's place.
  kWrongAddress,        ///< The module's chip answers at a place where the design has no module.
  kDuplicateAddress,    ///< Two chips answer at one place.
  kUnexpectedChip,      ///< A chip answers where the design has no module.
  kWrongId,             ///< The chip that answers is not an AD7147.
  kStuckLine,           ///< SDA or SCL of a line is or was held low.
  kLostConfiguration,   ///< The chip was configured again after its supply dipped.
  kIntermittentModule,  ///< The module answers now but did not for some time.
  kSaturatedTaxel,      ///< The taxel reads an end of its range.
  kFrozenTaxel,         ///< The taxel always reads the same value.
  kDriftingChip,        ///< All taxels of the module drift while those of others rest.
  kStaleRest,           ///< Taxels no longer rest where they did at the last tare.
  kNoTouchResponse,     ///< No taxel changes when the module is pressed.
  kTouchedOtherModule,  ///< Another module answers when this one is pressed.
  kSwappedModules,      ///< Two modules have exchanged their places.
  kWrongOrder,          ///< Three or more modules are at each other's places.
  kMirroredPatch,       ///< A patch is mounted mirrored or turned.
  kSwappedLines,        ///< Two lines of a patch are exchanged at its cable.
  kLooseJoint,          ///< All modules behind a joint or cable disappeared at the same time.
  kSaggingSupply,       ///< Modules at the ends of a tree lost their configuration or are silent together.

  kMissingModule,  ///< A module of the design was not found.
  kExtraModule,    ///< A module was found that fits nowhere in the design.
  kMissingJoint,   ///< No signal passes a joint of the design.
  kExtraJoint,     ///< A joint was found between ports that the design does not join.
  kRotatedModule,  ///< The module is turned by 120° or 240° against the design.
  kWrongEntry,     ///< The cable is plugged into another side or module.
  kSecondCable,    ///< The patch is read through its second cable.
  kAdoptedModule,  ///< The module's own controller cannot reach it, so the controller of another patch reads it.
};

/// Reports and --json use these names.
inline constexpr NameTable kFindingKindNames{std::array<std::pair<FindingKind, std::string_view>, 38>{{
    {FindingKind::kAbsentController, "absent_controller"},
    {FindingKind::kDuplicateController, "duplicate_controller"},
    {FindingKind::kNotFlashed, "not_flashed"},
    {FindingKind::kWrongTable, "wrong_table"},
    {FindingKind::kWrongKind, "wrong_kind"},
    {FindingKind::kBackupRoute, "backup_route"},
    {FindingKind::kLostSamples, "lost_samples"},
    {FindingKind::kCrashedController, "crashed_controller"},
    {FindingKind::kWrongFirmware, "wrong_firmware"},
    {FindingKind::kWrongPatch, "wrong_patch"},
    {FindingKind::kAbsentModule, "absent_module"},
    {FindingKind::kWrongAddress, "wrong_address"},
    {FindingKind::kDuplicateAddress, "duplicate_address"},
    {FindingKind::kUnexpectedChip, "unexpected_chip"},
    {FindingKind::kWrongId, "wrong_id"},
    {FindingKind::kStuckLine, "stuck_line"},
    {FindingKind::kLostConfiguration, "lost_configuration"},
    {FindingKind::kIntermittentModule, "intermittent_module"},
    {FindingKind::kSaturatedTaxel, "saturated_taxel"},
    {FindingKind::kFrozenTaxel, "frozen_taxel"},
    {FindingKind::kDriftingChip, "drifting_chip"},
    {FindingKind::kStaleRest, "stale_rest"},
    {FindingKind::kNoTouchResponse, "no_touch_response"},
    {FindingKind::kTouchedOtherModule, "touched_other_module"},
    {FindingKind::kSwappedModules, "swapped_modules"},
    {FindingKind::kWrongOrder, "wrong_order"},
    {FindingKind::kMirroredPatch, "mirrored_patch"},
    {FindingKind::kSwappedLines, "swapped_lines"},
    {FindingKind::kLooseJoint, "loose_joint"},
    {FindingKind::kSaggingSupply, "sagging_supply"},
    {FindingKind::kMissingModule, "missing_module"},
    {FindingKind::kExtraModule, "extra_module"},
    {FindingKind::kMissingJoint, "missing_joint"},
    {FindingKind::kExtraJoint, "extra_joint"},
    {FindingKind::kRotatedModule, "rotated_module"},
    {FindingKind::kWrongEntry, "wrong_entry"},
    {FindingKind::kSecondCable, "second_cable"},
    {FindingKind::kAdoptedModule, "adopted_module"},
}}};

}  // namespace triskin::diagnose
