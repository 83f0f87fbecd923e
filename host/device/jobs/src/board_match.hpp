// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/jobs/flash.hpp"

namespace triskin::device {

/// A controller on the bus and the patch that it is to serve.
struct Board {
  wire::NodeClaim claim;
  int patch = -1;  ///< −1: not needed
  FoundBy by = FoundBy::kNothing;
};

/// Decides which of the controllers `claims` gets which patch, and writes nothing. In this order: controllers that
/// `options.assign` names; those that hold a table of this design; those that never had a table, by the shapes of their
/// patches or in the order of their unique ids; with `options.take_over` those of another design. With `options.patch`
/// one patch alone is looked for. In a dry run addresses stay, and controllers that share one are not told apart.
/// Throws DeviceError naming the controllers and the remedy when a patch finds none, InputError for an assignment that
/// cannot be.
[[nodiscard]] std::vector<Board> match_boards(Bus& bus, const design::Design& design, const FlashOptions& options,
                                              const std::vector<wire::NodeClaim>& claims);

}  // namespace triskin::device
