// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/rest_values.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/bus.hpp"
#include "triskin/wire/adoption.hpp"
#include "triskin/wire/node_claim.hpp"
#include "triskin/wire/offsets.hpp"
#include "triskin/wire/settled_rest.hpp"

namespace triskin::session {

/// The controller of a patch has found these offsets for its converters, and its taxels then read these values.
struct PatchOffsets {
  layout::PatchIndex patch;
  std::vector<layout::ModuleId> modules;  ///< Each row has its module id in the design.
  wire::Offsets offsets;
  wire::SettledRest rest;
  wire::Adoption adoption;
};

/// Waits until the controllers `claims` have set up each of their converters or found out why they cannot, at most one
/// second: half a second after a board gets its power, else the time of one question each. One that does not answer is
/// not waited for. Throws Unreachable.
void wait_for_set_up(Bus& bus, std::span<const wire::NodeClaim> claims);
/// Finds the controllers first, which takes 0.12 s. Throws Unreachable.
void wait_for_set_up(Bus& bus);

/// Asks those of the controllers `claims` that have a table of the design. One that does not answer is left out. Throws
/// Unreachable, and DeviceError for a malformed answer.
[[nodiscard]] std::vector<PatchOffsets> read_offsets(Bus& bus, const design::Design& design,
                                                     std::span<const wire::NodeClaim> claims);
/// Finds the controllers first, which takes 0.12 s.
[[nodiscard]] std::vector<PatchOffsets> read_offsets(Bus& bus, const design::Design& design);

/// Returns where the taxels of a design rest as far as the controllers `claims` say: what each read when its offset was
/// settled. NaN: not known, because the offset is still searched, or because the module is read by a controller that
/// is not its own. Throws as read_offsets().
[[nodiscard]] design::RestValues settled_rest(Bus& bus, const design::Design& design,
                                              std::span<const wire::NodeClaim> claims);

}  // namespace triskin::session
