// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/mirror.hpp"

namespace triskin::pipeline {

struct EditedDesign {
  design::Design design;
  /// Maps an id of the old design to the new one, −1 if it was removed. A module that has an id is exactly where it
  /// was, or at its mirror image.
  std::vector<int> new_id;
  std::vector<int> added;                        ///< ids of the new design that the old one lacks
  std::vector<layout::PatchIndex> kept_patches;  ///< controllers whose number and table are as they were, ascending
};

/// Names a place for a new module: beside a module, or a tile of an island.
struct BesideModule {
  int module = 0;  ///< The id is that of the old design.
  int side = 0;    ///< The side must be free, 0 … 2.
};
struct TileOfIsland {
  int island = 0;  ///< The number is that of the old design.
  design::Tile tile;
};
using NewPlace = std::variant<BesideModule, TileOfIsland>;

/// Lists modules to remove, then places to fill, in this order; a tile may be beside one that was just added.
struct LayoutEdit {
  std::vector<int> remove;  ///< An id that is listed twice is removed once.
  std::vector<NewPlace> add;
};

/// Removes and adds modules; all others stay exactly where they are and keep their numbers (design/module_number.hpp),
/// and new ones get numbers that none had before. Controllers whose modules and joints stay keep their wiring; the rest
/// is wired around them. Islands are renumbered by their connections. Alternatives stay, none of them
/// is taken. A new module gets its kind by the regions of the design. Errors: InputError for an id, side or island that
/// does not exist, for a place that is not free or beside no module, and for a module that the limits forbid there,
/// naming the broken ones; for a design that would have no module; where the numbers end. Deterministic for the seed of
/// the design. Cost: as take_alternative(), and about 0.2 s per new module.
[[nodiscard]] EditedDesign edit_design(const design::Design& design, const LayoutEdit& edit,
                                       const ProgressSink& progress = {});

/// grow_around() throws InputError for a value out of range.
struct GrowAroundOptions {
  double time_limit_s = 20.0;  ///< It must be positive.
  int iterations = 0;          ///< If positive, the growth ends after this many steps of each chain.
  int threads = 2;             ///< The result depends on this number, 1 … 256.
};

/// Keeps modules exactly where they are, with numbers and wiring as edit_design(), and searches layouts for the rest of
/// the surface with the price and limits of the design. The layout of highest value is taken, with that of the design
/// among the candidates, so that the value never falls; the others become alternatives. Errors: InputError for an id
/// that does not exist and options out of range. Deterministic for seed, threads and iterations unless the time limit
/// cuts the search short. Cost: time_limit_s.
[[nodiscard]] EditedDesign grow_around(const design::Design& design, const std::vector<int>& kept,
                                       const GrowAroundOptions& options, const ProgressSink& progress = {});

/// Makes the design for the other arm: surface, pieces, modules and alternatives are mirrored, measured and wired anew.
/// Ids and numbers stay. The name gets "_mirrored", or loses it. Deterministic for the seed of the design. Cost: as
/// take_alternative().
[[nodiscard]] EditedDesign mirror_design(const design::Design& design, const design::MirrorPlane& plane,
                                         const ProgressSink& progress = {});

}  // namespace triskin::pipeline
