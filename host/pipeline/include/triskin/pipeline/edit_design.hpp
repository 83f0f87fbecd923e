// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/mirror.hpp"

namespace triskin::pipeline {

/// A design made of another one, and what became of its modules.
struct EditedDesign {
  design::Design design;
  /// Indexed by the id in the old design: id in the new one, −1: removed. A module that has an id stands exactly
  /// where it stood, or at its mirror image.
  std::vector<int> new_id;
  std::vector<int> added;  ///< They are ids of the new design whose modules the old one lacks.
};

/// Place for a new module: beside a module, or a tile of an island.
struct BesideModule {
  int module = 0;  ///< It is an id of the old design.
  int side = 0;    ///< It is a free side, 0 … 2.
};
struct TileOfIsland {
  int island = 0;  ///< It is a number of the old design.
  design::Tile tile;
};
using NewPlace = std::variant<BesideModule, TileOfIsland>;

/// Modules that go, and places that get one, in this order; a tile may hang on one that was just added.
struct LayoutEdit {
  std::vector<int> remove;  ///< They are ids; one that is named twice is removed once.
  std::vector<NewPlace> add;
};

/// Removes and adds modules; all others stay exactly where they are. Islands are numbered anew by what hangs together,
/// and jumpers, controllers and wiring are made again. Alternatives stay, none of them is taken. A new module gets its
/// kind by the regions of the design. Errors: InputError for an id, side or island that is not there, for a place
/// that is not free or beside no module, and for a module that the limits do not let stand there, naming those that
/// it breaks; for a design that is left without a module. Deterministic for the seed of the design. Cost: as
/// take_alternative(), and about 0.2 s a new module.
[[nodiscard]] EditedDesign edit_design(const design::Design& design, const LayoutEdit& edit,
                                       const ProgressSink& progress = {});

/// Effort of grow_around(). Out of range: InputError.
struct GrowAroundOptions {
  double time_limit_s = 20.0;  ///< It must be positive.
  int iterations = 0;          ///< If positive, the growth ends after so many steps of each chain.
  int threads = 2;             ///< The result depends on this number, 1 … 256.
};

/// Keeps modules exactly where they are and searches layouts for the rest of the surface with the price and limits of
/// the design; the layout of highest value stays, that of the design among them, so that the value never falls. The
/// others are the alternatives. Errors: InputError for an id that is not there and options out of range.
/// Deterministic for seed, threads and iterations unless the time limit cuts the search short. Cost: time_limit_s.
[[nodiscard]] EditedDesign grow_around(const design::Design& design, const std::vector<int>& kept,
                                       const GrowAroundOptions& options, const ProgressSink& progress = {});

/// The design for the other arm: surface, pieces, modules and alternatives are mirrored, measured and wired anew. Ids
/// stay. The name gets "_mirrored", or loses it. Deterministic for the seed of the design. Cost: as take_alternative().
[[nodiscard]] EditedDesign mirror_design(const design::Design& design, const design::MirrorPlane& plane,
                                         const ProgressSink& progress = {});

}  // namespace triskin::pipeline
