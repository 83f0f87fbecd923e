// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <numbers>

#include "triskin/fabrication/flat_island.hpp"
#include "triskin/fabrication/nesting.hpp"

// Writes DXF R12 (AC1009), because every program reads it and it needs neither handles nor object tables.
namespace triskin::fabrication {
namespace {

using design::Vec2;

struct DxfLayer {
  const char* name;
  int colour;  // The colour is an AutoCAD colour index.
};
constexpr std::array<DxfLayer, 6> kDxfLayers{
    {{"OUTLINE", 7}, {"HOLES", 1}, {"FOLDS", 5}, {"SLITS", 6}, {"MARKS", 3}, {"SHEET", 8}}};

// Programs that know the variable, which is newer than R12, take the numbers as millimetres (4).
std::string header() {
  std::string text =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n"
      "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n";
  text += fmt::format("70\n{}\n", kDxfLayers.size());
  for (const DxfLayer& layer : kDxfLayers)
    text += fmt::format("0\nLAYER\n2\n{}\n70\n0\n62\n{}\n6\nCONTINUOUS\n", layer.name, layer.colour);
  return text + "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
}

std::string point(const Vec2& p) {
  return fmt::format("10\n{:.6f}\n20\n{:.6f}\n30\n0.0\n", p.x(), p.y());
}

std::string closed_line(const char* layer, const std::vector<Vec2>& ring) {
  std::string text = fmt::format("0\nPOLYLINE\n8\n{}\n66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n70\n1\n", layer);
  for (const Vec2& p : ring) text += fmt::format("0\nVERTEX\n8\n{}\n{}", layer, point(p));
  return text + fmt::format("0\nSEQEND\n8\n{}\n", layer);
}

std::string line(const char* layer, const Vec2& from, const Vec2& to) {
  return fmt::format("0\nLINE\n8\n{}\n{}11\n{:.6f}\n21\n{:.6f}\n31\n0.0\n", layer, point(from), to.x(), to.y());
}

// Writes a text with its middle at its place: with groups 72 and 73 the second point counts.
std::string centered_text(const char* layer, const Mark& mark) {
  return fmt::format("0\nTEXT\n8\n{}\n{}40\n{:.3f}\n1\n{}\n50\n{:.4f}\n72\n1\n11\n{:.6f}\n21\n{:.6f}\n31\n0.0\n73\n2\n",
                     layer, point(mark.at_mm), mark.height_mm, mark.text, mark.angle_rad * 180.0 / std::numbers::pi,
                     mark.at_mm.x(), mark.at_mm.y());
}

Mark angle_mark(const Fold& fold) {
  return {
      (fold.from_mm + fold.to_mm) / 2.0,
      fmt::format("{:+.0f}%%d{}", fold.angle_rad * 180.0 / std::numbers::pi, fold.carries_lines ? "" : " cut traces"),
      1.2, text_angle_rad(fold)};
}

std::string drawn(const FlatIsland& island) {
  std::string text = closed_line("OUTLINE", island.outline_mm);
  for (const auto& hole : island.holes_mm) text += closed_line("HOLES", hole);
  for (const Fold& fold : island.folds)
    text += line("FOLDS", fold.from_mm, fold.to_mm) + centered_text("MARKS", angle_mark(fold));
  for (const Slit& slit : island.slits) text += line("SLITS", slit.from_mm, slit.to_mm);
  for (const Mark& mark : island.marks) text += centered_text("MARKS", mark);
  return text;
}

const char* const kEnd = "0\nENDSEC\n0\nEOF\n";

}  // namespace

std::string island_dxf(const FlatIsland& island) {
  return header() + drawn(island) + kEnd;
}

std::string sheet_dxf(const std::vector<FlatIsland>& islands, const Nesting& nesting, int sheet,
                      const SheetOptions& options) {
  const double w = options.width_mm, l = options.length_mm;
  std::string text = header() + closed_line("SHEET", {{0, 0}, {w, 0}, {w, l}, {0, l}});
  for (const NestedIsland& place : nesting.places) {
    if (place.sheet == sheet) text += drawn(on_sheet(islands[place.island], place));
  }
  return text + kEnd;
}

}  // namespace triskin::fabrication
