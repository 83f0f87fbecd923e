// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/sheet/plan.hpp"

namespace triskin::sheet {

/// Returns false when this program was built without Cairo or libqrencode; then pdf() and svg() throw.
[[nodiscard]] bool can_draw();

/// Only switched modules have second cables; a design plans them in any case.
enum class SheetModules { kStrapped, kSwitched };

/// Draws the assembly sheet as PDF, one page per page of the plan, at true scale (docs/sheet.md), without second cables
/// for strapped modules. Equal designs give equal bytes on one installation of Cairo and fonts, since no date is
/// written. Errors: InputError for a design
/// without modules, and naming the packages when can_draw() is false. Cost: O(faces log faces + n log n), some 10 kB
/// per page.
[[nodiscard]] std::string pdf(const design::Design& design, Paper paper,
                              SheetModules modules = SheetModules::kStrapped);

/// Draws the same as one SVG in mm, the pages below one another; text is drawn as outlines. Throws InputError as pdf()
/// does; cost as there.
[[nodiscard]] std::string svg(const design::Design& design, Paper paper,
                              SheetModules modules = SheetModules::kStrapped);

}  // namespace triskin::sheet
