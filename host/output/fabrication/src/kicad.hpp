// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/fabrication/flat_island.hpp"
#include "triskin/sheet/sides.hpp"

/// Writes files of KiCad 6 (s-expressions of version 20211014). docs/fabrication.md says what is on which layer.
namespace triskin::fabrication {

/// Returns the board of an island: its edge, a footprint "Triskin:Module" per module with nets, rings and joints as
/// tracks, the tracks inside each module, closed straps, pads for the cables of entries and jumpers, folds on User.1,
/// slits on User.2, marks on User.3. Errors: InputError for a corner cut above kMaxBoardCornerCut_mm. Cost: linear.
[[nodiscard]] std::string island_board(const design::Design& design, const sheet::Sides& sides,
                                       const FlatIsland& island);

/// Returns the project file for a board, with the design rules by which KiCad checks it. Cost: constant.
[[nodiscard]] std::string board_project(const std::string& file_name);

/// Returns the net list of an island as a schematic editor would export it: modules and cables with their nets. Cost:
/// linear.
[[nodiscard]] std::string island_netlist(const design::Design& design, const sheet::Sides& sides,
                                         const FlatIsland& island);

/// Returns the module alone: footprint, symbol (ports and taxels), and its net list with chip, capacitors, straps and
/// taxels as components. Cost: constant.
[[nodiscard]] std::string module_footprint();
[[nodiscard]] std::string module_symbol();
[[nodiscard]] std::string module_netlist();
/// Returns the board of one module that belongs to no patch: all straps are open. Cost: that of island_board().
[[nodiscard]] std::string module_alone();

}  // namespace triskin::fabrication
