// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>

#include "canvas.hpp"
#include "triskin/sheet/plan.hpp"

namespace triskin::sheet {

/// What the drawing of a page needs.
struct Drawing {
  Canvas& canvas;
  const design::Design& design;
  const Plan& plan;
  const Page& page;
  int number = 1;                      ///< It is the number of the page.
  const IslandPage* island = nullptr;  ///< the one that is being drawn
};

/// Title, QR code and ruler, on every page.
void draw_frame(const Drawing& d);
/// The part from its six sides, with islands, entries and landmarks.
void draw_overview(const Drawing& d);
/// The key of all symbols.
void draw_key(const Drawing& d);
/// A text page.
void draw_text(const Drawing& d);
/// Islands at 1:1.
void draw_islands(const Drawing& d);
/// Labels to cut out and stick.
void draw_labels(const Drawing& d);

/// What is drawn inside of a module.
struct ModuleMarks {
  std::string number;
  int line = 0, address = 0, rotation = 0;
  bool up = true;  ///< One corner points upwards on the page, not downwards.
  int patch = -1;
  double corner_cut_mm = 0.0;
};
/// The ground of a module on its three corners (page, mm, tile order), and a hairline around it. Comes before the marks
/// of its neighbours, whose arrows cross the joint.
void draw_ground(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks);
/// Number, straps, port letters and the arrow of port A of a module.
void draw_module(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks);

/// A side that is a joint: dashed, with crosses where its traces are cut.
void draw_joint(Canvas& canvas, const Vec2& from, const Vec2& to, bool cut);
/// Pen of a line that is cut through.
inline constexpr Pen kCutThrough{0.5, kBlack, 0.0};
/// A red cross, `half_mm` to each side.
void draw_cross(Canvas& canvas, const Vec2& at, double half_mm, double width_mm);
/// A landmark of the part.
void draw_landmark(Canvas& canvas, const Vec2& at, const std::string& name);
/// A symbol ⊕ with its name beside it, in a direction of length 1.
void draw_anchor(Canvas& canvas, const Vec2& at, const Vec2& outward, const std::string& name);
/// Arrow from `from` to `to` with a filled head.
void draw_arrow(Canvas& canvas, const Vec2& from, const Vec2& to, const Color& color);

/// Colour of a controller; `light` 0 … 1.
[[nodiscard]] Color color_of(int patch, double light);
/// "+12°", "−5°", "0°".
[[nodiscard]] std::string angle_text(double fold_rad);

}  // namespace triskin::sheet
