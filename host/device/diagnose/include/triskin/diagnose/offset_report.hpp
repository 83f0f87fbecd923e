// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/session/patch_offsets.hpp"

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

/// Returns a line for the patch, then lines for the taxels that rest outside the middle third of their range: how many
/// counts are left for pressure, or that they are at its end.
[[nodiscard]] std::vector<std::string> describe(const design::Design& design, const session::PatchOffsets& patch);

}  // namespace triskin::diagnose
