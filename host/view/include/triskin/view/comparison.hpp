// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// Two designs as one, for a page that shows them side by side.
struct Comparison {
  design::Design design;  ///< modules of the earlier design, then those of the later one, each in its own mesh frame
  Notes notes;            ///< the covers "before" and "after", and what became of each module
};

/// What changed from `before` to `after`. A module is kept where both designs have one with the same three corners,
/// within 0.05 mm; that holds for designs that `design --like` or `edit` made of each other. Throws InputError when
/// their corner cuts differ. Cost: O(modules · log modules).
[[nodiscard]] Comparison compare(const design::Design& before, const design::Design& after);

}  // namespace triskin::view
