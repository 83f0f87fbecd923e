// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/deploy/board_shape.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::deploy {

struct BusBoards {
  /// The claims list the controllers that answer, with their present addresses; empty means that nobody was asked yet.
  std::vector<wire::NodeClaim> claims;
  std::map<wire::UniqueId, BoardShape> shapes;  ///< Shapes are known for the boards that were asked.
};

/// A controller on the bus will serve this patch.
struct Board {
  wire::NodeClaim claim;
  layout::PatchIndex patch = layout::PatchIndex::none();  ///< −1 means that the board is not needed.
  FoundBy by = FoundBy::kNothing;
};

struct MissingBoard {
  layout::PatchIndex patch;
  std::string why;  ///< The reason is a sentence.
};

struct MatchedBoards {
  std::vector<Board> boards;          ///< The order is that of the claims.
  std::vector<MissingBoard> missing;  ///< The list is sorted by patch.
};

/// Decides which of the controllers in `known.claims` gets which patch, without writing anything; it adds shapes to
/// `known`. The order of preference is: controllers that `options.assign` names; those with a table of this design;
/// those that never had a table, by the shapes of their patches or in the order of their unique ids; with
/// `options.take_over`, those of another design. With `options.patch` only one patch is considered. In a dry run
/// addresses do not change, and controllers that share one are not distinguished. If controllers are missing, those
/// that are named or have a table of this design get their patches, but none is chosen by shape or order, because the
/// missing one could be any of them. Throws DeviceError naming the controllers and the remedy when a patch finds none
/// and none is certain, or when controllers of another design could serve; InputError for an invalid assignment.
[[nodiscard]] MatchedBoards match_boards(session::Bus& bus, const design::Design& design, const FlashOptions& options,
                                         BusBoards& known);

}  // namespace triskin::deploy
