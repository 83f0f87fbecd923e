// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "drawing.hpp"
#include "pages.hpp"
#include "triskin/sheet/page_code.hpp"

namespace triskin::sheet {
namespace {

constexpr double kRuler_mm = 100.0, kCode_mm = 22.0, kTableCode_mm = 15.0;

// Draws a ruler of 100 mm from `from`, along `along`; its ticks point to `aside`.
void draw_ruler(Canvas& canvas, const Vec2& from, const Vec2& along, const Vec2& aside) {
  canvas.line(from, from + kRuler_mm * along, {0.2, kBlack, 0.0});
  for (int mm = 0; mm <= 100; ++mm) {
    const double tick_mm = mm % 10 == 0 ? 3.0 : mm % 5 == 0 ? 2.2 : 1.4;
    canvas.line(from + mm * along, from + mm * along + tick_mm * aside, {mm % 10 == 0 ? 0.2 : 0.1, kBlack, 0.0});
  }
  for (const int mm : {0, 50, 100})
    canvas.text(from + mm * along + 3.4 * aside + Vec2(0, aside.x() != 0.0 ? 0.8 : 0.0), std::to_string(mm),
                {.size_mm = 2.2,
                 .align = aside.x() > 0.0   ? 0.0
                          : aside.x() < 0.0 ? 1.0
                                            : 0.5});
}

}  // namespace

void draw_frame(const Drawing& d) {
  const Vec2 size = d.page.size_mm;
  const PageCode code{d.design.design_id, d.page.patch, d.number};
  draw_qr(d.canvas, text_of(code), {size.x() - kMargin_mm - kCode_mm, kMargin_mm}, kCode_mm);
  d.canvas.text({kMargin_mm, kMargin_mm + 6.0}, fmt::format("{}: {}", d.design.name, d.page.title),
                {.size_mm = 5.5, .bold = true});
  d.canvas.text({kMargin_mm, kMargin_mm + 11.0},
                fmt::format("page {} of {}  ·  design {:016x}  ·  {}", d.number, d.plan.pages.size(),
                            d.design.design_id, text_of(code)),
                {.size_mm = 2.6});
  const double foot = size.y() - kMargin_mm;
  draw_ruler(d.canvas, {kMargin_mm, foot - 1.0}, {1, 0}, {0, -1});
  d.canvas.text({kMargin_mm + kRuler_mm + 8.0, foot - 1.0}, "100 mm? Measure before use; print at 100 %.",
                {.size_mm = 2.6});
  // No caption reaches the right side.
  if (d.page.kind == PageKind::kIsland)
    draw_ruler(d.canvas, {size.x() - kMargin_mm, foot - kFoot_mm}, {0, -1}, {-1, 0});
}

void draw_text(const Drawing& d) {
  double y = kMargin_mm + kHead_mm;
  for (const TextLine& line : d.page.lines) {
    y += height_mm(line.kind);
    const bool bold = line.kind == LineKind::kTitle || line.kind == LineKind::kHead;
    const double size_mm = line.kind == LineKind::kTitle ? 4.4 : 3.1;
    for (std::size_t k = 0; k < line.cells.size(); ++k)
      d.canvas.text({kMargin_mm + (k < line.columns_mm.size() ? line.columns_mm[k] : 0.0), y}, line.cells[k],
                    {.size_mm = size_mm, .bold = bold});
    if (line.patch >= 0)
      draw_qr(d.canvas, text_of(PageCode{d.design.design_id, line.patch, d.number}),
              {d.page.size_mm.x() - kMargin_mm - kTableCode_mm - 1.0, y - 4.0}, kTableCode_mm);
    if (line.kind == LineKind::kTick || line.kind == LineKind::kTickRow)
      d.canvas.rectangle({kMargin_mm + 0.5, y - 2.7}, {3.0, 3.0}, {0.25, kBlack, 0.0});
    if (line.kind == LineKind::kHead || line.kind == LineKind::kRow || line.kind == LineKind::kTickRow)
      d.canvas.line({kMargin_mm, y + 1.3}, {d.page.size_mm.x() - kMargin_mm, y + 1.3},
                    {0.1, line.kind == LineKind::kHead ? kBlack : kPale, 0.0});
  }
}

}  // namespace triskin::sheet
