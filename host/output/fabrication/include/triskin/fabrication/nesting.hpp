// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/fabrication/flat_island.hpp"

namespace triskin::fabrication {

/// Islands are cut from sheets of this size. All lengths are in mm.
struct SheetOptions {
  double width_mm = 300.0;   ///< The width ranges from 50 to 2000.
  double length_mm = 400.0;  ///< The length ranges from 50 to 2000.
  double gap_mm = 1.0;       ///< Islands keep this distance, 0 … 20, from each other and from the sheet's edge.
  int tries = 60;            ///< The effort of the search, 1 … 1000; 1 does not search.
  std::uint64_t seed = 1;    ///< The seed determines what the search tries.
};

/// A point p of the island lies at R(angle) · p + shift on its sheet; R turns counter-clockwise.
struct NestedIsland {
  std::size_t island = 0;  ///< The index refers to the list passed to nesting.
  int sheet = 0;
  double angle_rad = 0.0;  ///< The angle is a multiple of 30°.
  design::Vec2 shift_mm{0, 0};
};

/// A nesting places every island on a sheet.
struct Nesting {
  std::vector<NestedIsland> places;  ///< The places are in the order of the islands.
  std::vector<double> used_mm;       ///< Each sheet is used up to this length, including the gap at its end.
  std::vector<double> fill;          ///< Islands cover this share, 0 … 1, of the used part of each sheet.
};

/// Lays the islands on as few sheets as the search finds and keeps the last sheet short, in twelve orientations and
/// also inside the holes of others. The first layout lays one island after the other, largest first, as low as it goes;
/// then a guided local search shortens it (overlap_search.hpp), and exact distances close what its pixels of 0.5 mm
/// left open (compaction.hpp). Two searches, with the seed and the next one, run at the same time, and the better
/// layout counts. The gap is guaranteed. Deterministic for the seed; the effort is counted work, not time. Errors:
/// InputError for options out of range and, naming its part number, for an island that does not fit a sheet. Cost:
/// about 0.15 s a try for 14 or more islands, less for fewer, thus about 9 s on two cores by default; a sheet so large
/// that a step takes longer than a try adds that step.
[[nodiscard]] Nesting nest(const std::vector<FlatIsland>& islands, const SheetOptions& options);

/// Moves an island to its place on the sheet. Cost: linear.
[[nodiscard]] FlatIsland on_sheet(FlatIsland island, const NestedIsland& place);

/// Draws a sheet for a laser or a board house, like island_dxf() with an additional layer SHEET. Cost: linear.
[[nodiscard]] std::string sheet_dxf(const std::vector<FlatIsland>& islands, const Nesting& nesting, int sheet,
                                    const SheetOptions& options);

/// Lists the places as CSV (RFC 4180): part_number,sheet,x_mm,y_mm,angle_deg; sheets count from 1. A point p of the
/// island's own drawing is turned counter-clockwise by the angle and then moved by (x, y). Cost: linear.
[[nodiscard]] std::string places_csv(const std::vector<FlatIsland>& islands, const Nesting& nesting);

}  // namespace triskin::fabrication
