// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/pipeline/edit_design.hpp"

namespace triskin::pipeline {

/// Tells what became of an older design on a new version of its part.
struct Revision {
  /// Gives each module of the older design its id now, −1 if it was removed. A module that has an id did not move.
  std::vector<int> new_id;
  std::vector<int> added;                        ///< These ids belong to modules that the older design lacks.
  std::vector<layout::PatchIndex> kept_patches;  ///< controllers whose number and table are as they were, ascending
};

struct RevisedDesign {
  design::Design design;
  Revision revision;
};

/// Makes a design on the surface of `part`, which has no modules yet, with the modules of `old` wherever they keep the
/// limits on that surface; the rest is searched as grow_around() does. A patch keeps its wiring and index if all of its
/// modules stay and their joints are as they were; the rest is wired around it. Both parts must be in one frame.
/// Limits, price, seed, corner cut and kinds are those of `old`. Errors: InputError for options out of range.
/// Deterministic as grow_around(). Cost: options.time_limit_s and some seconds.
[[nodiscard]] RevisedDesign revise_design(const design::Design& old, design::Design part,
                                          const GrowAroundOptions& options, const ProgressSink& progress = {});

}  // namespace triskin::pipeline
