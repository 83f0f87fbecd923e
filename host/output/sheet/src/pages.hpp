// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/module_side.hpp"
#include "triskin/sheet/plan.hpp"

namespace triskin::sheet {

/// Returns the pages of all islands, in order of the islands; each module is on exactly one.
[[nodiscard]] std::vector<Page> island_pages(const design::Design& design, Paper paper);

/// Returns the text pages: parts, order of work, a table for each controller. They name pages by `plan`, whose page
/// numbers may still be 0; the number of lines does not depend on them.
[[nodiscard]] std::vector<Page> text_pages(const design::Design& design, const Plan& plan, Paper paper);

/// Returns the labels of all controllers and jumpers, on as many pages as they need.
[[nodiscard]] std::vector<Page> label_pages(const design::Design& design, const Plan& plan, Paper paper);

/// Writes the radius to which a module is bent as "R 27": mm, rounded down.
[[nodiscard]] std::string bend_text(double radius_mm);

/// Returns the paper size of overview, key and text pages, mm.
[[nodiscard]] design::Vec2 text_size_mm(Paper paper);

/// Returns the height of a line of a text page, mm.
[[nodiscard]] double height_mm(LineKind kind);

/// Returns the letter of the port at a tile side of a module that is turned by `rotation`.
[[nodiscard]] constexpr char port_at(int side, int rotation) {
  return static_cast<char>('A' + design::port_at_side(side, rotation));
}

/// Writes where a point lies: "R2 118.4 mm, R5 87.0 mm".
[[nodiscard]] std::string text_of(const Fix& fix, const std::vector<Landmark>& landmarks);

/// Describes a side for the table of a controller: the module over a joint, "cut (13)", "edge, mark m7", "cable".
[[nodiscard]] std::string text_of(const Side& side, const design::Design& design, const Plan& plan);

}  // namespace triskin::sheet
