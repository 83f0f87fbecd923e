// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/sheet/plan.hpp"

namespace triskin::sheet {

/// Pages of all islands, in order of the islands; each module is on exactly one.
[[nodiscard]] std::vector<Page> island_pages(const design::Design& design, Paper paper);

/// Text pages: parts, order of work, a table for each controller. They name pages by `plan`, whose page numbers may
/// still be 0; the number of lines does not depend on them.
[[nodiscard]] std::vector<Page> text_pages(const design::Design& design, const Plan& plan, Paper paper);

/// Labels of all controllers and jumpers, on as many pages as they need.
[[nodiscard]] std::vector<Page> label_pages(const design::Design& design, const Plan& plan, Paper paper);

/// "R 27": radius to which a module is bent, mm, rounded down.
[[nodiscard]] std::string bend_text(double radius_mm);

/// Paper of overview, key and text pages, mm.
[[nodiscard]] design::Vec2 text_size_mm(Paper paper);

/// Height of a line of a text page, mm.
[[nodiscard]] double height_mm(LineKind kind);

/// Letter of the port at a tile side of a module that is turned by `rotation`.
[[nodiscard]] constexpr char port_at(int side, int rotation) {
  return static_cast<char>('A' + (side + 3 - rotation) % 3);
}

/// "R2 118.4 mm, R5 87.0 mm": where a point lies.
[[nodiscard]] std::string text_of(const Fix& fix, const std::vector<Landmark>& landmarks);

/// What is at a side, for the table of a controller: the module over a joint, "cut (13)", "edge, mark m7", "cable".
[[nodiscard]] std::string text_of(const Side& side, const design::Design& design, const Plan& plan, int module);

}  // namespace triskin::sheet
