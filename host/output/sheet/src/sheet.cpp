// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/sheet/sheet.hpp"

#include "drawing.hpp"

namespace triskin::sheet {
namespace {

void draw_page(const Drawing& d) {
  draw_frame(d);
  switch (d.page.kind) {
    case PageKind::kOverview:
      return draw_overview(d);
    case PageKind::kKey:
      return draw_key(d);
    case PageKind::kText:
      return draw_text(d);
    case PageKind::kLabels:
      return draw_labels(d);
    case PageKind::kIsland:
      return draw_islands(d);
  }
}

std::string draw(design::Design design, Paper paper, SheetModules modules, Canvas::Kind kind) {
  if (modules == SheetModules::kStrapped) {
    for (design::Patch& patch : design.patches) patch.second_entry = patch.second_entry_side = -1;
  }
  const Plan plan = plan_of(design, paper);
  std::vector<Vec2> sizes_mm;
  for (const Page& page : plan.pages) sizes_mm.push_back(page.size_mm);
  Canvas canvas(kind, design.name, std::move(sizes_mm));
  int number = 0;
  for (const Page& page : plan.pages) {
    canvas.next_page();
    draw_page({canvas, design, plan, page, ++number, nullptr});
  }
  return canvas.finish();
}

}  // namespace

bool can_draw() {
  return Canvas::is_built();
}

std::string pdf(const design::Design& design, Paper paper, SheetModules modules) {
  return draw(design, paper, modules, Canvas::Kind::kPdf);
}

std::string svg(const design::Design& design, Paper paper, SheetModules modules) {
  return draw(design, paper, modules, Canvas::Kind::kSvg);
}

}  // namespace triskin::sheet
