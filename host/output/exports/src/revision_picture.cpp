// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/revision_picture.hpp"

#include <algorithm>

#include "design_view.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::exports {
namespace {

bool faces_viewer(const design::PlacedModule& m, const View& view) {
  const design::Vec3 normal = (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized();
  return normal.dot(view.toward()) >= 0.05;
}

Shape module_shape(const design::PlacedModule& m, double corner_cut_mm, const View& view, const char* style,
                   double above) {
  const design::Outline outline = design::outline_of(m.corner_mm, corner_cut_mm);
  const double height = view.height((m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0);
  return {height + above, polygon(view, outline.points(), style)};
}

Shape number_shape(const design::PlacedModule& m, design::ModuleNumber number, const View& view) {
  const design::Vec3 middle = (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
  const design::Vec2 at = view.flat(middle);
  return {view.height(middle) + 1e6, fmt::format("<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" "
                                                 "font-size=\"7\" text-anchor=\"middle\">{}</text>\n",
                                                 at.x(), at.y() + 2.5, number)};
}

void add_modules_now(const design::Design& now, const std::vector<int>& added, const View& view,
                     std::vector<Shape>& shapes) {
  for (std::size_t k = 0; k < now.layout.modules.size(); ++k) {
    const design::PlacedModule& m = now.layout.modules[k];
    if (!faces_viewer(m, view)) continue;
    const bool is_new = std::ranges::find(added, static_cast<int>(k)) != added.end();
    shapes.push_back(module_shape(m, now.layout.corner_cut_mm, view,
                                  is_new ? "class=\"new\" fill=\"#3a3\" stroke=\"#222\" stroke-width=\"0.6\""
                                         : "class=\"kept\" fill=\"#ccd\" stroke=\"#667\" stroke-width=\"0.6\"",
                                  1.0));
    if (is_new) shapes.push_back(number_shape(m, design::number_of(now, static_cast<int>(k)), view));
  }
}

}  // namespace

std::string revision_svg(const design::Design& old, const design::Design& now, const std::vector<int>& new_id,
                         const std::vector<int>& added) {
  const View view(now);
  std::vector<Shape> shapes;
  add_surface(now, view, shapes);
  add_modules_now(now, added, view, shapes);
  for (std::size_t k = 0; k < new_id.size(); ++k) {
    const design::PlacedModule& m = old.layout.modules.at(k);
    if (new_id[k] >= 0 || !faces_viewer(m, view)) continue;
    shapes.push_back(module_shape(m, old.layout.corner_cut_mm, view,
                                  "class=\"gone\" fill=\"none\" stroke=\"#c00\" stroke-width=\"1.5\"", 2e6));
  }
  std::ranges::stable_sort(shapes, {}, &Shape::height);
  const design::Vec2 low = view.box().min() - design::Vec2(10, 10), size = view.box().sizes() + design::Vec2(20, 34);
  std::string svg = svg_head(low, size);
  for (const Shape& s : shapes) svg += s.svg;
  const auto gone = std::ranges::count(new_id, -1);
  return svg + fmt::format(
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" font-family=\"sans-serif\" font-size=\"{:.1f}\">{}: {} stay "
                   "(grey), {} new (green), {} gone (red)</text>\n</svg>\n",
                   low.x() + 10, low.y() + size.y() - 10, size.x() / 40, escape_markup(now.name),
                   static_cast<std::ptrdiff_t>(new_id.size()) - gone, added.size(), gone);
}

}  // namespace triskin::exports
