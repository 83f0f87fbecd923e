// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::placement {

/// place_lattices() throws InputError for a value out of its range.
struct LatticesOptions {
  int max_lattices = 0;        ///< 1 … 1000; 0: as many as help.
  double gap_mm = 0.0;         ///< Between any two modules, of one lattice or of two; 0 … 100.
  double tolerance_mm = 1e-6;  ///< A module may overhang the outline, or another module, by this much; 1e-8 … 1.
  double time_limit_s = 20.0;  ///< Positive.
  int steps = 0;               ///< If positive, the search ends after so many steps, and the answer repeats.
  std::uint64_t seed = 1;
};

/// Modules on one isometric grid of its own, as place() describes it.
struct FlatLattice {
  Placement placement;
  std::vector<Tile> tiles;
};

struct FlatLayout {
  std::vector<FlatLattice> lattices;  ///< Most modules first.
  int modules = 0;
  int upper_bound = 0;  ///< No number of lattices holds more (modules_bound()).
  int steps = 0;
  double seconds = 0.0;
};

/// Places whole modules on several lattices in one flat outline (mm; any polygon that place() takes), each lattice
/// moved on its own, so that no two modules come nearer to each other than the gap. Ruin and recreate, beginning with
/// `one`, the answer of place() for this polygon, gap and tolerance: never fewer modules than that. Deterministic for
/// seed and `steps` unless the time limit cuts the search short. Errors: InputError as place(). Cost: time_limit_s,
/// less if the bound is met; O(vertices + modules) memory.
[[nodiscard]] FlatLayout place_lattices(const Polygon& polygon, const FlatLattice& one, const LatticesOptions& options,
                                        const ProgressSink& progress = {});

/// Returns a number of modules that no layout exceeds, however its modules are turned: the area that a module can
/// reach, by parts that hang together, over the area of a module (docs/placement.md has the proof). `polygon` must be
/// normalized. Cost: some 50 ms.
[[nodiscard]] int modules_bound(const Polygon& polygon, double gap_mm, double tolerance_mm);

/// Returns the layout as `triskin place --lattices` writes it and `triskin check` judges it (docs/placement.md).
[[nodiscard]] std::string flat_layout_text(const Polygon& polygon, const FlatLayout& layout,
                                           const LatticesOptions& options);

}  // namespace triskin::placement
