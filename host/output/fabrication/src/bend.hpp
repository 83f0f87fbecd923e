// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/fabrication/flat_island.hpp"
#include "triskin/sheet/sides.hpp"

/// A joint is not a line but a bend: an area without plated holes, parts and taxels.
namespace triskin::fabrication {

/// Thickness of the board: four layers of copper, three of polyimide, cover and mask (kicad_board.cpp).
inline constexpr double kBoardThickness_mm = 4 * 0.018 + 3 * 0.05 + 2 * 0.025;
/// Inner radius of a joint that is bent once and then held. Fabricators ask for 10 … 15 times the thickness of boards
/// with more than two layers (docs/fabrication.md); the lower end holds here, because copper of one layer alone crosses
/// the bend.
inline constexpr double kBendRadius_mm = 10.0 * kBoardThickness_mm;
/// The wall of a plated hole keeps this distance from the bend.
inline constexpr double kHoleToBend_mm = 0.5;

/// Returns how far the bend of a joint reaches to either side of it on the flat board: half of its arc, along the
/// middle of the board. Constant cost.
[[nodiscard]] constexpr double bend_reach_mm(double angle_rad) {
  return (kBendRadius_mm + kBoardThickness_mm / 2.0) * (angle_rad < 0.0 ? -angle_rad : angle_rad) / 2.0;
}

/// Returns the largest angle at which no pad of a module lies in the bend, nor a hole too near to it; from the pads of
/// module_board.hpp. Cost: linear in the pads.
[[nodiscard]] double module_bend_limit_rad();

/// Returns the largest angle of a side at which a cable is soldered: its tracks lie nearer to the side than anything
/// else.
[[nodiscard]] double cable_bend_limit_rad();

/// Errors: InputError naming the joint of the island that is bent farthest beyond module_bend_limit_rad(), or beyond
/// cable_bend_limit_rad() if a cable is soldered to one of its sides.
void require_bends(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island);

}  // namespace triskin::fabrication
