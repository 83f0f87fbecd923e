// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>

#include "canvas.hpp"
#include "triskin/sheet/plan.hpp"

namespace triskin::sheet {

/// Passes to the drawing functions everything that a page needs.
struct Drawing {
  Canvas& canvas;
  const design::Design& design;
  const Plan& plan;
  const Page& page;
  int number = 1;
  const IslandPage* island = nullptr;  ///< Only the island that is being drawn is set.
};

/// Every page has a title, a QR code and a ruler.
void draw_frame(const Drawing& d);
/// Shows the part from its six sides, with islands, entries and landmarks.
void draw_overview(const Drawing& d);
/// Explains all symbols.
void draw_key(const Drawing& d);
void draw_text(const Drawing& d);
/// The scale is 1:1.
void draw_islands(const Drawing& d);
/// Labels are meant to be cut out and stuck.
void draw_labels(const Drawing& d);

struct ModuleMarks {
  std::string number;
  int line = 0, address = 0, rotation = 0;
  bool up = true;  ///< True means that one corner points upwards on the page, false downwards.
  int patch = -1;
  double corner_cut_mm = 0.0;
};
/// Fills a module on its three corners (page, mm, tile order), with a hairline around it. Must precede the marks of its
/// neighbours, whose arrows cross the joint.
void draw_ground(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks);
/// Draws number, straps, port letters and the arrow of port A of a module.
void draw_module(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks);

/// Draws a side that is a joint as a dashed line, with crosses if its traces are cut.
void draw_joint(Canvas& canvas, const Vec2& from, const Vec2& to, bool cut);
/// Lines that are cut through have this pen.
inline constexpr Pen kCutThrough{0.5, kBlack, 0.0};
/// Draws a red cross that extends `half_mm` to each side.
void draw_cross(Canvas& canvas, const Vec2& at, double half_mm, double width_mm);
void draw_landmark(Canvas& canvas, const Vec2& at, const std::string& name);
/// Draws a symbol ⊕ with its name beside it, in a direction of length 1.
void draw_anchor(Canvas& canvas, const Vec2& at, const Vec2& outward, const std::string& name);
/// Draws an arrow from `from` to `to` with a filled head.
void draw_arrow(Canvas& canvas, const Vec2& from, const Vec2& to, const Color& color);

/// Returns the colour of a controller; `light` is 0 … 1.
[[nodiscard]] Color color_of(int patch, double light);
/// Returns "+12°", "−5°" or "0°".
[[nodiscard]] std::string angle_text(double fold_rad);

}  // namespace triskin::sheet
