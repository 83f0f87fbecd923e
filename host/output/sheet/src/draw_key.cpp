// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>

#include "drawing.hpp"

namespace triskin::sheet {
namespace {

// Draws each symbol with a line of text beside it.
class Key {
 public:
  Key(Canvas& canvas, double top_mm) : canvas_(canvas), y_(top_mm) {}
  /// Returns the middle of the place of the next symbol.
  Vec2 next(std::initializer_list<const char*> text, double height_mm) {
    const Vec2 middle(kMargin_mm + 18.0, y_ + height_mm / 2.0);
    double line = middle.y() + 1.0 - 2.3 * (static_cast<double>(text.size()) - 1.0);
    for (const char* t : text) {
      canvas_.text({kMargin_mm + 42.0, line}, t, {});
      line += 4.6;
    }
    y_ += height_mm;
    return middle;
  }

 private:
  Canvas& canvas_;
  double y_;
};

void draw_example(Canvas& canvas, const Vec2& middle) {
  // The symbol is larger than a real module, so that nobody measures it.
  const double half = 18.0, height = 2.0 * half * 0.8660254;
  const std::array<Vec2, 3> corners{middle + Vec2(-half, height / 3), middle + Vec2(half, height / 3),
                                    middle + Vec2(0, -2 * height / 3)};
  for (const auto draw : {draw_ground, draw_module})
    draw(canvas, corners, {.number = "17", .line = 2, .address = 1, .rotation = 1});
}

// Returns the ends of a line around its middle, 24 mm long, as on the pages.
std::pair<Vec2, Vec2> line_at(const Vec2& middle) {
  return {middle - Vec2(12, 0), middle + Vec2(12, 0)};
}

void key_of_sides(Canvas& c, Key& key) {
  const auto [from, to] =
      line_at(key.next({"Cut through: outline of the island, slit, corner that is cut off."}, 10.0));
  c.line(from, to, kCutThrough);
  const Vec2 kept = key.next(
      {"Joint to keep: it carries lines. Fold it by its angle:", "+12° away from you, −12° towards you."}, 12.0);
  draw_joint(c, line_at(kept).first, line_at(kept).second, false);
  c.text(kept + Vec2(-2, -0.8), "+12°", {.size_mm = 2.0});
  const Vec2 cut =
      key.next({"Joint to cut: cut its traces, all of them, so that it carries no line; then fold it like the others.",
                "Between two controllers (two colours) all joints are cut."},
               12.0);
  draw_joint(c, line_at(cut).first, line_at(cut).second, true);
}

void key_of_cables(Canvas& c, Key& key, bool has_second_cables) {
  const Vec2 cable =
      key.next({"The cable of controller 3 is plugged in here, at port A of its entry module.",
                has_second_cables ? "2nd cable: of switched modules. Beside another module: C3, and C3* for the 2nd."
                                  : "Beside another module: C3."},
               12.0);
  draw_arrow(c, cable + Vec2(0, -4), cable + Vec2(0, 4), kBlue);
  c.text(cable + Vec2(-1.5, 0), "cable C3", {.size_mm = 2.6, .bold = true, .align = 1.0, .color = kBlue});
  const Vec2 jumper =
      key.next({"Jumper J0: a short cable from this side to port B of module 45, 9 mm along the surface."}, 12.0);
  c.fill_rectangle(jumper - Vec2(1.2, -1.8), {2.4, 2.4}, kBlue);
  c.line(jumper + Vec2(0, 3), jumper, {0.6, kBlue, 0.0});
  c.text(jumper + Vec2(0, -0.8), "J0 → 45 port B, 9 mm", {.size_mm = 2.2, .align = 0.5, .color = kBlue});
}

void key_of_marks(Canvas& c, Key& key) {
  const Vec2 mark =
      key.next({"Matching mark: this side lies opposite side m7 of module 45 over a seam, 2.3 mm apart."}, 12.0);
  const auto [from, to] = line_at(mark + Vec2(0, 2));
  c.line(from, to, kCutThrough);
  c.line(mark + Vec2(0, 2), mark + Vec2(0, -0.2), {0.5, kBlack, 0.0});
  c.text(mark + Vec2(0, -1), "m7 → 45, gap 2.3", {.size_mm = 2.2, .align = 0.5});
  const Vec2 next =
      key.next({"The island goes on with module 45 on page 12: lay the pages so that the red crosses coincide."}, 12.0);
  draw_cross(c, line_at(next).first, 2.0, 0.15);
  draw_cross(c, line_at(next).second, 2.0, 0.15);
  c.text(next + Vec2(0, 0.8), "45 on page 12", {.size_mm = 2.2, .align = 0.5, .color = kRed});
  const Vec2 anchor =
      key.next({"Point of an island whose place on the part is stated: distances from two landmarks, in a straight",
                "line (calipers or compasses)."},
               12.0);
  draw_anchor(c, anchor, Vec2(1.0, -1.0).normalized(), "P");
  const Vec2 bend =
      key.next({"The surface bends under this module: the drawn triangle is flat, the real one is bent to this",
                "radius, mm. It is written where that is less than 50."},
               10.0);
  c.text(bend + Vec2(0, 0.8), "R 27", {.size_mm = 2.4, .bold = true, .align = 0.5, .color = kRed});
  (void)key.next(
      {"Tables of controllers: a number is the module to which the joint is kept; cut: the traces of the joint",
       "are cut; edge: the outline of the island; m: mark across a seam."},
      10.0);
  draw_landmark(
      c,
      key.next({"Landmark of the part: R on a rim, S of a part without rim (overview, list on the page of parts)."},
               12.0),
      "R1");
}

}  // namespace

void draw_key(const Drawing& d) {
  Canvas& c = d.canvas;
  Key key(c, kMargin_mm + kHead_mm);
  draw_example(
      c, key.next({"A module, seen from outside, the side that is touched: its number (17); the line strap: of the",
                   "four pads the black one, third from the left, is closed with solder, the others stay open (L2);",
                   "the address strap: of its four pads the two black ones, ADD0H and ADD1L (address 2D).",
                   "Pads from left to right: L0 L1 L2 L3, and ADD0L ADD0H ADD1L ADD1H. The page stands upright.",
                   "A, B and C are the ports; the black arrow goes into port A, its input.",
                   "The colour of the ground tells controllers apart."},
                  46.0) +
             Vec2(0, 4));
  key_of_sides(c, key);
  key_of_cables(c, key, std::ranges::any_of(d.design.patches, [](const auto& p) { return p.second_entry >= 0; }));
  key_of_marks(c, key);
  (void)key.next({"The QR code of a page holds the design, the controller (−: none) and the page. triskin verify and",
                  "triskin view take its text instead of a design file; they find the design in the current folder."},
                 12.0);
}

}  // namespace triskin::sheet
