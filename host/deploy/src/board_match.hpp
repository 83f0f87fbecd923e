// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/deploy/board_shape.hpp"
#include "triskin/deploy/flash.hpp"

namespace triskin::device {

/// Known facts about the boards on a bus, shared by all covers of one pass.
struct BusBoards {
  /// Who answers, with the addresses that they have; nobody: not asked yet.
  std::vector<wire::NodeClaim> claims;
  std::map<wire::UniqueId, BoardShape> shapes;  ///< They are the shapes of the boards that were asked.
};

/// A controller on the bus and the patch that it is to serve.
struct Board {
  wire::NodeClaim claim;
  int patch = -1;  ///< It is −1 for a board that is not needed.
  FoundBy by = FoundBy::kNothing;
};

/// A patch that no controller serves.
struct MissingBoard {
  int patch = 0;
  std::string why;  ///< It is a sentence.
};

struct MatchedBoards {
  std::vector<Board> boards;          ///< They stand in the order of the claims.
  std::vector<MissingBoard> missing;  ///< They are sorted by patch.
};

/// Decides which of the controllers `known.claims` gets which patch, and writes nothing; `known` gets the shapes. In
/// this order: controllers that `options.assign` names; those that hold a table of this design; those that never had a
/// table, by the shapes of their patches or in the order of their unique ids; with `options.take_over` those of another
/// design. With `options.patch` one patch alone is looked for. In a dry run addresses stay, and controllers that share
/// one are not told apart. Where controllers are missing, those that are named or hold a table of this design get their
/// patches, and nobody is told by shape or order: the missing one could be any of them. Throws DeviceError naming the
/// controllers and the remedy when a patch finds none and none is certain, or controllers of another design would do;
/// InputError for an assignment that cannot be.
[[nodiscard]] MatchedBoards match_boards(Bus& bus, const design::Design& design, const FlashOptions& options,
                                         BusBoards& known);

}  // namespace triskin::device
