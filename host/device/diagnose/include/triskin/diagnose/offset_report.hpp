// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::diagnose {

/// Reports use these names for the states of a module's offsets and for the moment when its converter shows its
/// results.
inline constexpr NameTable kOffsetStateNames{
    std::array<std::pair<wire::OffsetState, std::string_view>, 5>{{{wire::OffsetState::kNone, "none"},
                                                                   {wire::OffsetState::kSearching, "searching"},
                                                                   {wire::OffsetState::kKept, "kept"},
                                                                   {wire::OffsetState::kFound, "found"},
                                                                   {wire::OffsetState::kOutside, "outside"}}}};
inline constexpr NameTable kLatchingNames{
    std::array<std::pair<wire::Latching, std::string_view>, 3>{{{wire::Latching::kUnknown, "unknown"},
                                                                {wire::Latching::kEachStage, "each_stage"},
                                                                {wire::Latching::kEndOfSequence, "end_of_sequence"}}}};

/// The controller of a patch has found these offsets for its converters.
struct PatchOffsets {
  layout::PatchIndex patch;
  std::vector<layout::ModuleId> modules;  ///< Each row has its module id in the design.
  wire::Offsets offsets;
};

/// Asks every controller that has a table of the design; firmware 0.1 does not know offsets and is left out. Takes 0.2
/// s. Throws Unreachable, and DeviceError for a malformed answer.
[[nodiscard]] std::vector<PatchOffsets> read_offsets(session::Bus& bus, const design::Design& design);

/// Returns a line for the patch, then one for each module with a taxel that rests outside the middle third of its
/// range.
[[nodiscard]] std::vector<std::string> describe(const PatchOffsets& patch);

}  // namespace triskin::diagnose
