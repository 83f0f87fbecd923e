// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// A comparison merges two designs into one, so that a page can show them side by side.
struct Comparison {
  design::Design design;  ///< The earlier design's modules come first; each half keeps its own mesh frame.
  Notes notes;            ///< The notes name the covers "before" and "after" and classify each module.
};

/// Compares two designs. A module counts as kept if both designs have one with the same three corners, within 0.05 mm;
/// designs that `design --like` or `edit` derived from each other do. Throws InputError if their corner cuts differ.
/// Cost: O(modules · log modules).
[[nodiscard]] Comparison compare(const design::Design& before, const design::Design& after);

}  // namespace triskin::view
