// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/exports/export.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "design_view.hpp"
#include "module_names.hpp"
#include "triskin/base/ascii_name.hpp"
#include "triskin/base/csv_field.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/base/terminal_text.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/module_side.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::exports {
namespace {

design::Vec3 centroid(const design::PlacedModule& m) {
  return (m.corner_mm[0] + m.corner_mm[1] + m.corner_mm[2]) / 3.0;
}

std::string color_of(int patch, double light) {
  return fmt::format("hsl({:.0f},65%,{:.0f}%)", std::fmod(patch * 137.508, 360.0), light);
}

double facing(const design::PlacedModule& m, const View& view) {
  return (m.corner_mm[1] - m.corner_mm[0]).cross(m.corner_mm[2] - m.corner_mm[0]).normalized().dot(view.toward());
}

// A number is readable on a module that is turned away by less than 66°; of six sides one shows it below 55°.
constexpr double kReadable = 0.4;

// Only sides that show a number which those before them do not.
std::vector<View> sides_of(const design::Design& d) {
  std::vector<View> sides;
  std::vector<bool> is_read(d.layout.modules.size(), false);
  for (const View& view : View(d).sides(d)) {
    bool is_needed = sides.empty();
    for (std::size_t k = 0; k < is_read.size(); ++k) {
      if (is_read[k] || facing(d.layout.modules[k], view) < kReadable) continue;
      is_read[k] = is_needed = true;
    }
    if (is_needed) sides.push_back(view);
  }
  return sides;
}

void add_modules(const design::Design& d, const View& view, const std::vector<design::ModuleWiring>& wiring,
                 std::vector<Shape>& shapes) {
  for (std::size_t k = 0; k < d.layout.modules.size(); ++k) {
    const auto& m = d.layout.modules[k];
    const double front = facing(m, view);
    if (front < 0.05) continue;  // The module shows its back, so the surface hides it.
    const design::Outline outline = design::outline_of(m.corner_mm, d.layout.corner_cut_mm);
    const std::string fill = color_of(wiring[k].patch, 45 + 25 * front);
    shapes.push_back(
        {view.height(centroid(m)) + 1.0,
         polygon(view, outline.points(), fmt::format("fill=\"{}\" stroke=\"#222\" stroke-width=\"0.6\"", fill))});
    const design::Vec2 at = view.flat(centroid(m));
    const int parent = wiring[k].routed.parent;
    std::string mark = fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\" fill=\"#111\"/>\n", at.x(), at.y(),
                                   parent < 0 ? 3.5 : 1.2);
    if (parent >= 0) {
      const design::Vec2 from = view.flat(centroid(d.layout.modules[static_cast<std::size_t>(parent)]));
      mark += fmt::format(
          "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"#111\" stroke-width=\"1\"/>\n",
          from.x(), from.y(), at.x(), at.y());
    }
    shapes.push_back({view.height(centroid(m)) + 1e6, mark});  // The offset draws trees on top of all modules.
    if (front < kReadable) continue;
    shapes.push_back({view.height(centroid(m)) + 3e6,
                      fmt::format("<text class=\"number\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\" "
                                  "font-family=\"sans-serif\" font-size=\"6\" stroke=\"#fff\" stroke-width=\"1.2\" "
                                  "paint-order=\"stroke\">{}</text>\n",
                                  at.x(), at.y() + 6.5, design::number_of(d, static_cast<int>(k)))});
    // Of a robot the name of the cover stands under the number, so small that it fits into the module.
    if (const design::NamedCover* cover = design::cover_of(d, static_cast<int>(k)))
      shapes.push_back({view.height(centroid(m)) + 3e6,
                        fmt::format("<text class=\"cover\" x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\" "
                                    "font-family=\"sans-serif\" font-size=\"2.5\">{}</text>\n",
                                    at.x(), at.y() - 2.5, escape_markup(cover->name))});
  }
}

void add_jumpers(const design::Design& d, const View& view, std::vector<Shape>& shapes) {
  for (const design::Jumper& j : d.layout.jumpers) {
    const auto shows_front = [&](int node) {
      return facing(d.layout.modules.at(static_cast<std::size_t>(node)), view) > 0.05;
    };
    if (std::ranges::none_of(j.node, shows_front)) continue;
    std::array<design::Vec3, 2> end;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& corner = d.layout.modules.at(static_cast<std::size_t>(j.node[k])).corner_mm;
      const auto s = static_cast<std::size_t>(j.side[k]);
      end[k] = (corner[s] + corner[(s + 1) % 3]) / 2.0;
    }
    const design::Vec2 a = view.flat(end[0]), b = view.flat(end[1]);
    shapes.push_back({view.height(end[0]) + 2e6,
                      fmt::format("<line class=\"jumper\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" "
                                  "stroke=\"#d00\" stroke-width=\"3\" stroke-linecap=\"round\"/>\n",
                                  a.x(), a.y(), b.x(), b.y())});
  }
}

std::string kind_name(const design::Design& design, int module) {
  return design::kind_of(design.kinds, design.layout.modules.at(static_cast<std::size_t>(module)).kind).name;
}

std::string coverage_text(const design::Design& design) {
  const double whole = 100.0 * design.report.coverage, cut = 100.0 * design.report.coverage_cut;
  if (design.layout.corner_cut_mm <= 0.0) return fmt::format("coverage {:.0f} %", whole);
  return fmt::format("corners cut by {:g} mm, coverage {:.0f} % ({:.0f} % of whole triangles)",
                     design.layout.corner_cut_mm, cut, whole);
}

}  // namespace

std::string picture_svg(const design::Design& design) {
  constexpr double kGap_mm = 10.0;
  const auto wiring = design::wiring_of(design);
  std::string drawings;
  design::Vec2 size(kGap_mm, 0.0);
  for (const View& view : sides_of(design)) {
    std::vector<Shape> shapes;
    add_surface(design, view, shapes);
    add_modules(design, view, wiring, shapes);
    add_jumpers(design, view, shapes);
    std::ranges::stable_sort(shapes, {}, &Shape::height);
    const design::Vec2 shift = design::Vec2(size.x(), kGap_mm) - view.box().min();
    drawings += fmt::format("<g transform=\"translate({:.2f},{:.2f})\">\n", shift.x(), shift.y());
    for (const Shape& s : shapes) drawings += s.svg;
    drawings += "</g>\n";
    size += design::Vec2(view.box().sizes().x() + kGap_mm, 0.0);
    size.y() = std::max(size.y(), view.box().sizes().y() + kGap_mm + 24.0);
  }
  const design::Vec2 low(0.0, 0.0);
  std::string svg = svg_head(low, size) + drawings;
  svg += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-family=\"sans-serif\" font-size=\"{:.1f}\">{}: {} modules, {} controllers, "
      "{}</text>\n</svg>\n",
      low.x() + 10, low.y() + size.y() - 10, std::min(size.x() / 32, 8.0), escape_markup(design.name),
      design.layout.modules.size(), design::patches_of(design).size(), coverage_text(design));
  return svg;
}

std::string taxels_csv(const design::Design& design) {
  std::string csv = "cover,module,taxel,patch,line,address,x_mm,y_mm,z_mm,nx,ny,nz";
  csv += design.kinds.empty() ? "\n" : ",kind\n";
  const auto wiring = design::wiring_of(design);
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    const int id = static_cast<int>(k);
    const std::string cover = csv_field(for_terminal(cover_name(design, id)));  // Tables are also read in a terminal.
    const design::ModuleNumber module = design::number_of(design, id);
    const int patch = patch_in_cover(design, id, wiring[k].patch);
    const auto taxels = design::taxels_of(design.layout.modules[k], wiring[k].routed.rotation);
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      const auto& [p, n] = taxels[t];
      csv += fmt::format("{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.6f},{:.6f},{:.6f}", cover, module, t, patch,
                         wiring[k].routed.line, wiring[k].routed.address, p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
      csv += design.kinds.empty() ? "\n" : fmt::format(",{}\n", csv_field(kind_name(design, static_cast<int>(k))));
    }
  }
  return csv;
}

namespace {

std::string face_line(std::size_t vertices_before, std::size_t corners) {
  std::string line = "f";
  for (std::size_t k = 1; k <= corners; ++k) line += fmt::format(" {}", vertices_before + k);
  return line + "\n";
}

}  // namespace

std::string modules_obj(const design::Design& design) {
  std::string obj = fmt::format("# triskin modules, mm\no {}\n", ascii_name(design.name, "-.", "modules"));
  std::size_t corners = 3;  // Each module has this many vertices in the file.
  for (const auto& m : design.layout.modules) {
    const design::Outline outline = design::outline_of(m.corner_mm, design.layout.corner_cut_mm);
    corners = outline.size;
    for (const design::Vec3& c : outline.points()) obj += fmt::format("v {:.6f} {:.6f} {:.6f}\n", c.x(), c.y(), c.z());
  }
  const auto wiring = design::wiring_of(design);
  for (std::size_t k = 0; k < wiring.size(); ++k) {
    const int id = static_cast<int>(k), patch = patch_in_cover(design, id, wiring[k].patch);
    std::string cover;
    if (const design::NamedCover* c = design::cover_of(design, id)) cover = ascii_name(c->name, "", "cover") + "_";
    obj += "g " + module_name(design, id) + (patch < 0 ? "" : fmt::format(" {}patch_{}", cover, patch)) + "\n";
    obj += face_line(corners * k, corners);
  }
  return obj;
}

}  // namespace triskin::exports
