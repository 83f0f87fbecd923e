// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/pipeline/edit_design.hpp"

namespace triskin::pipeline {

/// What became of an older design on a new version of its part.
struct Revision {
  std::vector<int> new_id;     ///< by module of the older design: id now, −1: gone. One that is there did not move
  std::vector<int> added;      ///< ids of modules that the older design lacks
  std::vector<int> new_patch;  ///< by patch of the older design: the patch that is wired exactly as it was, −1: none
};

/// A design on the surface of `part`, which has no modules yet, with the modules of `old` wherever they keep the limits
/// on that surface; the rest is searched as grow_around() does. A patch stays, with its wiring and index, where all of
/// its modules do and their joints are as they were; what is left is wired around. Both parts lie in one frame. Limits,
/// price, seed, corner cut and kinds are those of `old`. Errors: InputError for options out of range. Deterministic as
/// grow_around(). Cost: options.time_limit_s and some seconds.
[[nodiscard]] design::Design revise_design(const design::Design& old, design::Design part,
                                           const GrowAroundOptions& options, Revision& revision,
                                           const ProgressSink& progress = {});

}  // namespace triskin::pipeline
