// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "drawing.hpp"
#include "module_geometry.hpp"
#include "pages.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::sheet {
namespace {

// One side of a module on the page, without its cut corners.
struct PageSide {
  Vec2 from, to, outward;
  [[nodiscard]] Vec2 middle() const { return (from + to) / 2.0; }
  // Text reads from left to right along the side.
  [[nodiscard]] double turn_rad() const {
    const Vec2 along = to - from;
    const double angle = std::atan2(along.y(), along.x());
    return std::abs(angle) > std::numbers::pi / 2.0 + 1e-6 ? angle - std::copysign(std::numbers::pi, angle) : angle;
  }
};

PageSide side_on(const Drawing& d, int module, int side) {
  const auto corners = d.island->corners_of(d.design.layout.modules[index(module)].tile);
  const double part = d.design.layout.corner_cut_mm / design::kSide_mm;
  const Vec2 &a = corners[index(side)], &b = corners[index((side + 1) % 3)];
  const Vec2 center = (corners[0] + corners[1] + corners[2]) / 3.0;
  return {a + part * (b - a), b - part * (b - a), ((a + b) / 2.0 - center).normalized()};
}

bool is_joint(const Side& side) {
  return side.kind == SideKind::kKept || side.kind == SideKind::kCut || side.kind == SideKind::kApart;
}

void write_along(const Drawing& d, const PageSide& at, double part, double out_mm, const std::string& text,
                 const TextLook& look) {
  TextLook turned = look;
  turned.turn_rad = at.turn_rad();
  turned.align = 0.5;
  // Text is placed by its baseline, so outside of a lower side it begins one line lower.
  const Vec2 up(std::sin(turned.turn_rad), -std::cos(turned.turn_rad));
  const double shift_mm = at.outward.dot(up) * out_mm >= 0.0 ? 0.0 : -0.75 * look.size_mm;
  d.canvas.text(at.from + part * (at.to - at.from) + out_mm * at.outward + shift_mm * up, text, turned);
}

// Returns the position of a mark's text along its side. In a notch of the outline the two sides of a mark meet; their
// texts keep away from the corner, or they would overlap (each is 20 mm long and 5 mm high with its distance).
double part_of_mark(const Drawing& d, const PageSide& at, int match, int other) {
  constexpr double kAway = 4.0 / design::kSide_mm;
  if (d.design.layout.modules[index(other)].island != d.island->island) return 0.5;
  for (int s = 0; s < 3; ++s) {
    if (d.plan.sides.of[index(other)][index(s)].match != match) continue;
    const PageSide far = side_on(d, other, s);
    if ((far.to - at.from).norm() < 0.5 * design::kSide_mm) return 0.5 + kAway;
    if ((far.from - at.to).norm() < 0.5 * design::kSide_mm) return 0.5 - kAway;
  }
  return 0.5;
}

void draw_match(const Drawing& d, const PageSide& at, const Side& side, int module) {
  const Match& match = d.plan.sides.matches[index(side.match)];
  const int other = match.module[match.module[0] == module ? 1 : 0];
  const design::ModuleNumber number = design::number_of(d.design, other);
  const bool slit = side.kind == SideKind::kSlit;
  const double out = slit ? -1.0 : 1.0;
  const bool brief = slit || side.cable || side.second_cable;  // There is no room for more.
  const double part = side.cable || side.second_cable ? 0.8 : part_of_mark(d, at, side.match, other);
  const Vec2 foot = at.from + part * (at.to - at.from);
  d.canvas.line(foot, foot + out * 2.2 * at.outward, {0.5, kBlack, 0.0});
  write_along(d, at, part, out * 2.8,
              brief ? fmt::format("m{} → {}", side.match, number)
                    : fmt::format("m{} → {}, gap {:.1f}", side.match, number, match.gap_mm),
              {.size_mm = 2.2});
}

void draw_jumper(const Drawing& d, const PageSide& at, const Side& side, int module) {
  const auto& j = d.design.layout.jumpers[index(side.jumper)];
  const std::size_t far = j.node[0] == module ? 1 : 0;
  d.canvas.fill_rectangle(at.middle() - Vec2(1.2, 1.2), {2.4, 2.4}, kBlue);
  d.canvas.line(at.middle(), at.middle() + 3.0 * at.outward, {0.6, kBlue, 0.0});
  write_along(d, at, 0.5, 3.6,
              fmt::format("{} → port {}, {:.0f} mm", design::jumper_name(d.design, j),
                          port_at(j.side[far], d.plan.wiring[index(j.node[far])].routed.rotation),
                          std::ceil(j.length_mm - 1e-9)),
              {.size_mm = 2.2, .color = kBlue});
}

void draw_cable(const Drawing& d, const PageSide& at, const Side& side, int module) {
  if (!side.cable && !side.second_cable) return;
  const int patch = d.plan.wiring[index(module)].patch;
  const bool is_beside_another = is_joint(side) || side.kind == SideKind::kSlit;
  const double from_mm = is_beside_another ? 4.0 : 9.0;
  draw_arrow(d.canvas, at.middle() + from_mm * at.outward, at.middle(), kBlue);
  if (is_beside_another) {
    // The neighbour limits the room: 4 mm remain between the arrow and the angle or the crosses.
    write_along(d, at, 0.595, 0.7, fmt::format("C{}{}", patch, side.cable ? "" : "*"),
                {.size_mm = 1.8, .bold = true, .color = kBlue});
    return;
  }
  // Along the side, the name stays within the room that is kept free around an island.
  write_along(d, at, 0.5, from_mm + 0.8, fmt::format("{}cable C{}", side.cable ? "" : "2nd ", patch),
              {.size_mm = 2.6, .bold = true, .color = kBlue});
}

// Draws a module of another page pale, so that the pages can be laid together.
void draw_ghost(const Drawing& d, const PageSide& at, int other) {
  for (int s = 0; s < 3; ++s) {
    const PageSide side = side_on(d, other, s);
    d.canvas.line(side.from, side.to, {0.15, kPale, 1.0});
    d.canvas.line(side.to, side_on(d, other, (s + 1) % 3).from, {0.15, kPale, 1.0});
  }
  for (const Vec2& p : {at.from, at.to}) draw_cross(d.canvas, p, 2.0, 0.15);
  write_along(d, at, 0.5, 3.2,
              fmt::format("{} on page {}", design::number_of(d.design, other), d.plan.page_of_module[index(other)]),
              {.size_mm = 2.2, .color = kRed});
}

void draw_side(const Drawing& d, int module, int s, const std::set<int>& here) {
  const Side& side = d.plan.sides.of[index(module)][index(s)];
  const PageSide at = side_on(d, module, s);
  const bool elsewhere = side.other >= 0 && !here.contains(side.other);
  const bool first = side.other < 0 || elsewhere || module < side.other;
  if (is_joint(side)) {
    if (first) draw_joint(d.canvas, at.from, at.to, side.kind != SideKind::kKept);
    if (first) write_along(d, at, 0.3, -0.8, angle_text(side.fold_rad), {.size_mm = 2.0});
  } else {
    d.canvas.line(at.from, at.to, kCutThrough);
  }
  if (elsewhere) draw_ghost(d, at, side.other);
  if (side.match >= 0) draw_match(d, at, side, module);
  if (side.jumper >= 0) draw_jumper(d, at, side, module);
  draw_cable(d, at, side, module);
}

ModuleMarks marks_of(const Drawing& d, int module) {
  const auto& wiring = d.plan.wiring[index(module)];
  const bool up = d.design.layout.modules[index(module)].tile.up != (d.island->sixths % 2 == 1);
  return {fmt::format("{}", design::number_of(d.design, module)),
          wiring.routed.line,
          wiring.routed.address,
          wiring.routed.rotation,
          up,
          wiring.patch,
          d.design.layout.corner_cut_mm};
}

void draw_short_sides(const Drawing& d, int module) {
  if (d.design.layout.corner_cut_mm <= 0.0) return;
  for (int s = 0; s < 3; ++s)
    d.canvas.line(side_on(d, module, s).to, side_on(d, module, (s + 1) % 3).from, kCutThrough);
}

// Returns the direction away from the modules of the page that meet at a corner, where no other text is.
Vec2 outward_at(const Drawing& d, const Vec2& corner) {
  Vec2 sum = Vec2::Zero();
  for (const int id : d.island->modules) {
    const auto corners = d.island->corners_of(d.design.layout.modules[index(id)].tile);
    const Vec2 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    if ((corner - center).norm() < 0.6 * design::kSide_mm)
      sum += corner - center;  // Its corners lie at 0.577 of a side.
  }
  return sum.norm() > 0.1 * design::kSide_mm ? Vec2(sum.normalized()) : Vec2(Vec2(1.0, -1.0).normalized());
}

std::string text_of_point(const Drawing& d, std::size_t k) {
  const Anchor& a = d.plan.anchors[index(d.island->island)][k];
  return fmt::format("{} (module {}{})", k == 0 ? "P" : "Q", design::number_of(d.design, a.module),
                     d.island->parts > 1 ? fmt::format(", page {}", d.plan.page_of_module[index(a.module)]) : "");
}

// Writes name and points: at the head of a page that shows one island, otherwise over each of them.
void draw_captions(const Drawing& d) {
  const auto& anchors = d.plan.anchors[index(d.island->island)];
  if (d.page.islands.size() == 1) {
    for (std::size_t k = 0; k < 2; ++k)
      d.canvas.text(
          {kMargin_mm, kMargin_mm + 20.0 + 4.0 * static_cast<double>(k)},
          fmt::format("Point {} on the part: {}.", text_of_point(d, k), text_of(anchors[k].fix, d.plan.landmarks)),
          {.size_mm = 2.6});
    return;
  }
  const Vec2& at = d.island->caption_mm;
  d.canvas.text(at, fmt::format("Island {}", d.island->island), {.size_mm = 3.4, .bold = true});
  for (std::size_t k = 0; k < 2; ++k)
    d.canvas.text(at + Vec2(0, 3.8 + 3.4 * static_cast<double>(k)),
                  fmt::format("{}: {}", text_of_point(d, k), text_of(anchors[k].fix, d.plan.landmarks)),
                  {.size_mm = 2.4});
}

void draw_anchors(const Drawing& d, const std::set<int>& here) {
  const auto& anchors = d.plan.anchors[index(d.island->island)];
  draw_captions(d);
  for (std::size_t k = 0; k < 2; ++k) {
    const Anchor& a = anchors[k];
    if (!here.contains(a.module)) continue;
    const Vec2 corner = d.island->corners_of(d.design.layout.modules[index(a.module)].tile)[index(a.corner)];
    draw_anchor(d.canvas, side_on(d, a.module, a.corner).from, outward_at(d, corner), k == 0 ? "P" : "Q");
  }
}

// The real module bends along the surface, but the drawn triangle is flat; the radius is written in the free corner.
void draw_bend(const Drawing& d, int module) {
  const double radius_mm = bend_radius_of_depth(d.design.layout.modules[index(module)].edge_depth_mm);
  if (radius_mm >= kPaperBendRadius_mm) return;
  const auto corners = d.island->corners_of(d.design.layout.modules[index(module)].tile);
  const Vec2 center = (corners[0] + corners[1] + corners[2]) / 3.0;
  d.canvas.text(center + Vec2(0, marks_of(d, module).up ? -8.4 : 9.6), bend_text(radius_mm),
                {.size_mm = 2.4, .bold = true, .align = 0.5, .color = kRed});
}

// A module with too little supply has its voltage in the free corner.
void draw_supply(const Drawing& d, int module) {
  const double volts = d.plan.supply_v[index(module)];
  if (volts >= d.plan.supply.needed_v()) return;
  const auto corners = d.island->corners_of(d.design.layout.modules[index(module)].tile);
  const Vec2 center = (corners[0] + corners[1] + corners[2]) / 3.0;
  d.canvas.text(center + Vec2(0, marks_of(d, module).up ? -11.0 : 12.2), fmt::format("{:.1f} V", volts),
                {.size_mm = 2.4, .bold = true, .align = 0.5, .color = kRed});
}

void draw_one(Drawing d) {
  const IslandPage& island = *d.island;
  const std::set<int> here(island.modules.begin(), island.modules.end());
  const Vec2 size = d.page.size_mm;
  d.canvas.begin_clip({kMargin_mm, kMargin_mm + kHead_mm},
                      size - Vec2(2.0 * kMargin_mm, 2.0 * kMargin_mm + kHead_mm + kFoot_mm));
  for (const auto draw : {draw_ground, draw_module}) {
    for (const int id : island.modules)
      draw(d.canvas, island.corners_of(d.design.layout.modules[index(id)].tile), marks_of(d, id));
  }
  for (const int id : island.modules) {
    for (int s = 0; s < 3; ++s) draw_side(d, id, s, here);
    draw_short_sides(d, id);
    draw_bend(d, id);
    draw_supply(d, id);
  }
  d.canvas.end_clip();
  draw_anchors(d, here);
}

}  // namespace

std::string bend_text(double radius_mm) {
  return fmt::format("R {:.0f}", std::floor(radius_mm));
}

void draw_islands(const Drawing& d) {
  d.canvas.text(
      {kMargin_mm, kMargin_mm + 16.0},
      fmt::format("Scale 1:1, seen from outside (the side that is touched). Long sides of a module: {:.2f} mm.",
                  design::kSide_mm - 2.0 * d.design.layout.corner_cut_mm),
      {.size_mm = 2.6});
  for (const IslandPage& island : d.page.islands) {
    Drawing one{d.canvas, d.design, d.plan, d.page, d.number, &island};
    draw_one(one);
  }
}

}  // namespace triskin::sheet
