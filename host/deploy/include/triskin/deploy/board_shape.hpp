// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/session/controller.hpp"

namespace triskin::device {

/// How the controller of a patch was found.
enum class FoundBy {
  kNothing,  ///< The board was not identified.
  kName,     ///< Somebody named the board.
  kTable,    ///< The board holds the table of this patch.
  kOnly,     ///< No other board was left.
  kShape,    ///< The board's modules have the shape of no other patch.
  kTouch,    ///< The board felt a finger on the patch.
  kOrder,    ///< Fresh controllers were taken in the order of their unique ids.
};
/// Names in --json.
inline constexpr NameTable kFoundByNames{std::array<std::pair<FoundBy, std::string_view>, 7>{{
    {FoundBy::kNothing, "nothing"},
    {FoundBy::kName, "name"},
    {FoundBy::kTable, "table"},
    {FoundBy::kOnly, "only"},
    {FoundBy::kShape, "shape"},
    {FoundBy::kTouch, "touch"},
    {FoundBy::kOrder, "order"},
}}};

/// What a controller sees of its patch without a table. Switched modules: all modules and joints, with their rotations
/// and the port of the cable. Strapped ones: the places at which a chip answers.
struct BoardShape {
  bool switched = false;
  wire::FoundTopology found;  ///< It is what a patch of switched modules found.
  /// For strapped modules, bit a of a line says that address a answers.
  std::array<std::uint8_t, layout::kLines> answers{};
};

/// Asks a controller that nobody shares its address with. Sampling pauses for up to 60 ms. Throws as Controller does.
[[nodiscard]] BoardShape read_shape(Controller& controller);

/// Number of differences between a shape and patch `patch` (0-based): modules, joints, rotations and the place of the
/// cable, or places with and without a chip. 0: none. -1: in so many that this is hardly the patch, or nothing
/// answers. Throws std::out_of_range for a patch that the design lacks. Cost: match_topology.
[[nodiscard]] int shape_difference(const BoardShape& shape, const design::Design& design, int patch);

/// The shape is what the controller of patch `patch` sees when its modules are joined to those of the patches beside
/// it, of which those in `open` (ascending) have no controller with a table: it reaches into them. Throws
/// std::out_of_range for a patch that the design lacks. Cost: topology_across.
[[nodiscard]] bool reaches_across(const BoardShape& shape, const design::Design& design, int patch,
                                  std::span<const int> open);

/// A patch that waits for its controller.
struct Seat {
  const design::Design* design = nullptr;
  int patch = 0;  ///< It is counted from 0 in its design.
};

/// Seat of each board, if its shape settles it. Seats are numbered as in the list.
struct ShapeAssignment {
  std::vector<int> seat;  ///< Each board has its seat; −1 means that the shapes do not settle it.
  /// Each board has the seats that it may have, in ascending order; with none it looks like no patch.
  std::vector<std::vector<int>> likely;
  /// One flag per board: it looks like one of them only with modules of the patches beside it.
  std::vector<bool> across;
  bool exact = false;  ///< Shapes that are equal give as many boards as possible a seat each.
};

/// Lays every shape over the patch of every seat (each once). A board may have any seat whose patch it equals; where
/// the boards do not cover the seats so, any that it differs from in at most one thing more than from the nearest. A
/// board is settled when it has the same seat in every way to give as many boards as possible a seat each: so equal
/// and symmetric shapes stay open, and a board that could have two seats is settled when another takes one of them.
/// Where patches are joined across their borders a board sees modules of the patches beside its own too: it equals a
/// seat as well when it reaches_across() into the patches of the other seats of that design. For that boards must have
/// looked one after the other. Cost: boards · seats calls of shape_difference and of reaches_across.
[[nodiscard]] ShapeAssignment assign_by_shape(std::span<const BoardShape> shapes, std::span<const Seat> seats);
/// Seats for these patches of a design, which outlives them.
[[nodiscard]] std::vector<Seat> seats_of(const design::Design& design, std::span<const int> patches);

/// Gives controllers without a table that share their node address addresses of their own, from the highest free one
/// downwards, so that each can be asked; with `tables` those with one, too. Nobody else is touched. Returns who is
/// there then. Throws DeviceError when addresses do not suffice or one is not taken.
[[nodiscard]] std::vector<wire::NodeClaim> put_apart(Bus& bus, std::vector<wire::NodeClaim> claims, bool tables);

}  // namespace triskin::device
