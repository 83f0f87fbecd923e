// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/verify_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "triskin/base/counted.hpp"
#include "triskin/base/markup.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/diagnose/repair.hpp"

namespace triskin::diagnose {
namespace {

std::string summary(const VerifyResult& r) {
  return fmt::format("{} of {} ok, {} touched; {}", r.modules_ok, counted(r.modules, "module"), r.touched,
                     counted(r.findings.size(), "finding"));
}

/// Maps each module to the number of its first finding, from 1.
std::map<int, std::size_t> marks_of(const VerifyResult& r) {
  std::map<int, std::size_t> marks;
  for (std::size_t k = 0; k < r.findings.size(); ++k) {
    for (const layout::ModuleId m : {r.findings[k].module, r.findings[k].other}) {
      if (m >= 0) marks.try_emplace(m, k + 1);
    }
  }
  return marks;
}

/// Draws one island of the lattice, with rows running upwards as on the assembly sheet.
std::string drawing(const design::Design& design, int island, const std::map<int, std::size_t>& marks) {
  std::string body;
  double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const design::PlacedModule& module = design.layout.modules[m];
    if (module.island != island) continue;
    std::string points;
    design::Vec2 centre{0, 0};
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = design::tile_corner_index(module.tile, k);
      const design::Vec2 p = design::grid_point(i, j);
      points += fmt::format("{:.1f},{:.1f} ", p.x(), -p.y());
      centre += p / 3.0;
      low_x = std::min(low_x, p.x());
      high_x = std::max(high_x, p.x());
      low_y = std::min(low_y, -p.y());
      high_y = std::max(high_y, -p.y());
    }
    const auto mark = marks.find(static_cast<int>(m));
    const bool marked = mark != marks.end();
    body += fmt::format("<polygon points=\"{}\"{}/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", points,
                        marked ? " class=\"bad\"" : "", centre.x(), -centre.y() + (marked ? 0 : 3),
                        design::number_of(design, static_cast<int>(m)));
    if (marked)
      body += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">({})</text>\n", centre.x(), -centre.y() + 8, mark->second);
  }
  constexpr double kScale = 0.4;  // of all islands alike; a module is then 12 mm wide on paper
  const double wide = high_x - low_x + 4, high = high_y - low_y + 4;
  return fmt::format("<svg width=\"{:.0f}mm\" height=\"{:.0f}mm\" viewBox=\"{:.0f} {:.0f} {:.0f} {:.0f}\">\n{}</svg>\n",
                     kScale * wide, kScale * high, low_x - 2, low_y - 2, wide, high, body);
}

std::string findings_table(const design::Design& design, const std::vector<Finding>& findings,
                           const std::string& arguments) {
  if (findings.empty()) return "";
  std::string html = "<table><tr><th><th>finding<th>on the cover<th>what was seen<th>what to do</tr>\n";
  for (std::size_t k = 0; k < findings.size(); ++k) {
    const Finding& f = findings[k];
    std::string steps;
    for (const std::string& s : repair_steps(design, f, arguments)) steps += "<li>" + escape_markup(s);
    html += fmt::format("<tr><td>({})<td>{}<td>{}<td>{}<td>{}{}</tr>\n", k + 1, kFindingKindNames.name(f.kind),
                        escape_markup(f.place), escape_markup(f.text), escape_markup(f.remedy),
                        steps.empty() ? "" : "<ol>" + steps + "</ol>");
  }
  return html + "</table>\n";
}

}  // namespace

std::string report_text(const design::Design& design, const VerifyResult& result, const std::string& arguments) {
  std::string text = fmt::format("{} (design {:016x})\n", design.name, design.design_id);
  for (std::size_t k = 0; k < result.findings.size(); ++k) {
    const Finding& f = result.findings[k];
    text += fmt::format("{}. {}: {}\n", k + 1, kFindingKindNames.name(f.kind), f.text);
    if (!f.place.empty()) text += fmt::format("    on the cover: {}\n", f.place);
    text += fmt::format("    {}\n", f.remedy);
    int step = 0;
    for (const std::string& s : repair_steps(design, f, arguments)) text += fmt::format("      {}. {}\n", ++step, s);
  }
  for (const Finding& f : result.earlier) text += fmt::format("remembered from before, not there now: {}\n", f.text);
  return text + summary(result) + "\n";
}

std::string report_html(const design::Design& design, const VerifyResult& result, const std::string& arguments) {
  std::string html = fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><title>{0}: verification</title>\n<style>body{{font:12pt "
      "sans-serif}}svg{{max-width:100%;margin:2mm}}polygon{{fill:#eee;stroke:#555}}polygon.bad{{fill:#f88}}"
      "text{{font:8px sans-serif;text-anchor:middle}}table{{border-collapse:collapse}}td,th{{border:1px solid "
      "#999;padding:2pt 6pt;text-align:left;vertical-align:top}}tr{{break-inside:avoid}}</style>\n<h1>{0}</h1>\n"
      "<p>Design {1:016x}. {2}.</p>\n",
      escape_markup(design.name), design.design_id, summary(result));
  const auto marks = marks_of(result);
  for (int island = 0; island < std::max(1, design.layout.islands); ++island) html += drawing(design, island, marks);
  html += findings_table(design, result.findings, arguments);
  for (const Finding& f : result.earlier)
    html += fmt::format("<p>Remembered from before, not there now: {}.</p>\n", escape_markup(f.text));
  return html;
}

}  // namespace triskin::diagnose
