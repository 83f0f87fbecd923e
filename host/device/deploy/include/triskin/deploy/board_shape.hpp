// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::deploy {

/// The controller of a patch can be found in these ways.
enum class FoundBy {
  kNothing,  ///< The board was not identified.
  kName,     ///< The user named the board.
  kTable,    ///< The board has the table of this patch.
  kOnly,     ///< No other board was left.
  kShape,    ///< The board's modules have the shape of no other patch.
  kTouch,    ///< The board felt a finger on the patch.
  kOrder,    ///< New controllers were assigned in the order of their unique ids.
};
/// The output of --json uses these names.
inline constexpr NameTable kFoundByNames{std::array<std::pair<FoundBy, std::string_view>, 7>{{
    {FoundBy::kNothing, "nothing"},
    {FoundBy::kName, "name"},
    {FoundBy::kTable, "table"},
    {FoundBy::kOnly, "only"},
    {FoundBy::kShape, "shape"},
    {FoundBy::kTouch, "touch"},
    {FoundBy::kOrder, "order"},
}}};

/// Without a table, a controller can see the shape of its patch. With switched modules it sees all modules and joints,
/// with their rotations and the port of the cable; with strapped ones, the places at which a chip answers.
struct BoardShape {
  bool switched = false;
  wire::FoundTopology found;  ///< A patch of switched modules found this topology.
  /// For strapped modules, bit a of a line says that a chip answers at address a.
  std::array<std::uint8_t, layout::kLines> answers{};
};

/// Reads the shape from a controller whose address is not shared. Sampling pauses for up to 60 ms. Throws as Controller
/// does.
[[nodiscard]] BoardShape read_shape(session::Controller& controller);

/// Counts the differences between a shape and patch `patch` (0-based): modules, joints, rotations and the place of the
/// cable, or places with and without a chip. 0 means that they are equal; −1 means that there are so many differences
/// that this is hardly the patch, or that nothing answers. Throws std::out_of_range for a patch that the design lacks.
/// Cost: match_topology.
[[nodiscard]] int shape_difference(const BoardShape& shape, const design::Design& design, layout::PatchIndex patch);

/// Returns true if the controller of patch `patch` sees this shape when its modules are joined to those of neighbouring
/// patches, and the patches in `open` (ascending) have no controller with a table, so that it reaches into them. Throws
/// std::out_of_range for a patch that the design lacks. Cost: topology_across.
[[nodiscard]] bool reaches_across(const BoardShape& shape, const design::Design& design, layout::PatchIndex patch,
                                  std::span<const layout::PatchIndex> open);

struct Seat {
  const design::Design* design = nullptr;
  layout::PatchIndex patch;
};

/// Boards are compared with seats. Seats are numbered as in the list.
struct ShapeAssignment {
  std::vector<int> seat;  ///< Each board has its seat; −1 means that the shapes do not decide it.
  /// Each board has its possible seats in ascending order; none means that it resembles no patch.
  std::vector<std::vector<int>> likely;
  /// Each board has a flag: true means that it matches a patch only together with modules of neighbouring patches.
  std::vector<bool> across;
  bool exact = false;  ///< True means that as many boards as possible get a seat by shapes that are equal.
};

/// Compares every shape with the patch of every seat (each once). A board may have any seat whose patch equals its
/// shape; if that does not fill the seats, also any seat with at most one difference more than the nearest. A board is
/// settled when it has the same seat in every assignment that gives a seat to as many boards as possible. Equal and
/// symmetric shapes therefore stay open, and a board with two possible seats is settled when another board takes one of
/// them. Where patches are joined across their borders, a board also sees modules of neighbouring patches, so it also
/// equals a seat when it reaches_across() into the patches of the design's other seats; for that, the boards must have
/// searched one after the other. Cost: boards · seats calls of shape_difference and of reaches_across.
[[nodiscard]] ShapeAssignment assign_by_shape(std::span<const BoardShape> shapes, std::span<const Seat> seats);
/// Makes seats for these patches of a design, which must outlive them.
[[nodiscard]] std::vector<Seat> seats_of(const design::Design& design, std::span<const layout::PatchIndex> patches);

/// Gives controllers without a table that share their node address separate addresses, from the highest free one
/// downwards, so that each can be asked; with `tables` also those with a table. Other controllers are not touched.
/// Returns the controllers that are present afterwards. Throws DeviceError when there are too few addresses or one is
/// not accepted.
[[nodiscard]] std::vector<wire::NodeClaim> put_apart(session::Bus& bus, std::vector<wire::NodeClaim> claims,
                                                     bool tables);

}  // namespace triskin::deploy
