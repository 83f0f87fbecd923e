// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>
#include <utility>

#include "triskin/base/names.hpp"

namespace triskin::device {

/// Kind of difference between hardware and design. The first group concerns controllers and their tables, the second
/// what the controllers read, the third the modules and joints that the route chain shows (docs/verify.md,
/// docs/switched_module.md).
enum class FindingKind {
  kAbsentController,     ///< no controller answers at the node address of the patch
  kDuplicateController,  ///< several controllers share the node address
  kNotFlashed,           ///< no controller has the table of the patch, and some have none
  kWrongTable,           ///< the controller holds another table
  kWrongKind,            ///< its table has the modules of the design, this one of another kind
  kBackupRoute,          ///< it holds the table that the design prepared for a failure
  kLostSamples,          ///< samples of the stream did not arrive
  kCrashedController,    ///< something stopped the controller: a fault, its watchdog, its clock
  kWrongPatch,           ///< its cable leads to the modules of another patch

  kAbsentModule,        ///< no chip answers at the module's place
  kWrongAddress,        ///< the module's chip answers at a place where the design has none
  kDuplicateAddress,    ///< two chips answer at one place
  kUnexpectedChip,      ///< a chip answers where the design has no module
  kWrongId,             ///< a chip answers that is no AD7147
  kStuckLine,           ///< SDA or SCL of a line is or was held low
  kLostConfiguration,   ///< the chip was set up again after its supply dipped
  kIntermittentModule,  ///< the module answers now and did not for some time
  kSaturatedTaxel,      ///< the taxel is at an end of its range
  kFrozenTaxel,         ///< the taxel keeps one value
  kStaleRest,           ///< taxels do not rest where they did when the skin was tared
  kNoTouchResponse,     ///< no taxel changes when the module is pressed
  kTouchedOtherModule,  ///< another module answers when it is pressed
  kSwappedModules,      ///< two modules sit at each other's place
  kWrongOrder,          ///< three modules or more sit at each other's places
  kMirroredPatch,       ///< a patch is mounted as its mirror image, or turned
  kSwappedLines,        ///< two lines of a patch are exchanged at its cable
  kLooseJoint,          ///< all modules behind a joint or cable were away together
  kSaggingSupply,       ///< all modules behind a joint or cable lost their configuration

  kMissingModule,  ///< of the design, not found
  kExtraModule,    ///< found, fits nowhere in the design
  kMissingJoint,   ///< of the design, nothing passes
  kExtraJoint,     ///< found between ports that the design does not join
  kRotatedModule,  ///< turned by 120° or 240° against the design
  kWrongEntry,     ///< the cable is plugged into another side or module
  kSecondCable,    ///< the patch is read over its second cable
  kAdoptedModule,  ///< out of reach of its controller; the controller of another patch reads it
};

/// Names in reports and in --json.
inline constexpr NameTable kFindingKindNames{std::array<std::pair<FindingKind, std::string_view>, 36>{{
    {FindingKind::kAbsentController, "absent_controller"},
    {FindingKind::kDuplicateController, "duplicate_controller"},
    {FindingKind::kNotFlashed, "not_flashed"},
    {FindingKind::kWrongTable, "wrong_table"},
    {FindingKind::kWrongKind, "wrong_kind"},
    {FindingKind::kBackupRoute, "backup_route"},
    {FindingKind::kLostSamples, "lost_samples"},
    {FindingKind::kCrashedController, "crashed_controller"},
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

}  // namespace triskin::device
