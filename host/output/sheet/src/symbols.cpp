// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drawing.hpp"
#include "pages.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::sheet {
namespace {

constexpr Vec2::Scalar kPad_mm = 2.0, kPadPitch_mm = 2.6, kRowLeft_mm = -7.2, kFirstPad_mm = -2.6;

Vec2 center_of(const std::array<Vec2, 3>& c) {
  return (c[0] + c[1] + c[2]) / 3.0;
}

// Draws a label and four pads; those to close are black.
void draw_strap(Canvas& canvas, const Vec2& middle, const std::string& label, std::initializer_list<int> closed) {
  canvas.text(middle + Vec2(kRowLeft_mm, 0.85), label, {.size_mm = 2.6, .bold = true});
  for (int k = 0; k < 4; ++k) {
    const Vec2 corner = middle + Vec2(kFirstPad_mm + kPadPitch_mm * k, -kPad_mm / 2.0);
    if (std::ranges::find(closed, k) != closed.end()) {
      canvas.fill_rectangle(corner, {kPad_mm, kPad_mm}, kBlack);
    } else {
      canvas.rectangle(corner, {kPad_mm, kPad_mm}, {0.15, kGrey, 0.0});
    }
  }
}

void draw_ports(Canvas& canvas, const std::array<Vec2, 3>& corners, int rotation) {
  const Vec2 center = center_of(corners);
  for (int side = 0; side < 3; ++side) {
    const Vec2 &from = corners[static_cast<std::size_t>(side)], &to = corners[static_cast<std::size_t>((side + 1) % 3)];
    const Vec2 out = ((from + to) / 2.0 - center).normalized(), along = (to - from).normalized();
    const bool input = side == rotation;
    canvas.text(center + 7.2 * out + 3.4 * along + Vec2(0, 0.8), std::string(1, port_at(side, rotation)),
                {.size_mm = 2.2, .bold = input, .align = 0.5, .color = input ? kBlack : kGrey});
  }
}

}  // namespace

Color color_of(int patch, double light) {
  if (patch < 0) return {light, light, light};
  const double hue = std::fmod(patch * 137.508, 360.0) / 60.0;
  const double spread = 0.65 * (1.0 - std::abs(2.0 * light - 1.0));
  const auto part = [&](double at) {
    const double turn = std::fmod(hue + at, 6.0);
    return light + spread * (std::clamp(std::abs(turn - 3.0) - 1.0, 0.0, 1.0) - 0.5);
  };
  return {part(0.0), part(4.0), part(2.0)};
}

std::string angle_text(double fold_rad) {
  const long degrees = std::lround(fold_rad * 180.0 / std::numbers::pi);
  return degrees == 0 ? "0°" : fmt::format("{}{}°", degrees > 0 ? "+" : "−", std::abs(degrees));
}

void draw_arrow(Canvas& canvas, const Vec2& from, const Vec2& to, const Color& color) {
  const Vec2 along = (to - from).normalized(), aside(-along.y(), along.x());
  const Vec2 neck = to - 2.6 * along;
  canvas.line(from, neck, {0.6, color, 0.0});
  canvas.fill(std::array{to, Vec2(neck + 1.2 * aside), Vec2(neck - 1.2 * aside)}, color);
}

void draw_cross(Canvas& canvas, const Vec2& at, double half_mm, double width_mm) {
  canvas.line(at - Vec2(half_mm, 0), at + Vec2(half_mm, 0), {width_mm, kRed, 0.0});
  canvas.line(at - Vec2(0, half_mm), at + Vec2(0, half_mm), {width_mm, kRed, 0.0});
}

void draw_landmark(Canvas& canvas, const Vec2& at, const std::string& name) {
  draw_cross(canvas, at, 1.6, 0.35);
  canvas.text(at + Vec2(0.6, -1.0), name, {.size_mm = 2.6, .bold = true, .color = kRed});
}

void draw_anchor(Canvas& canvas, const Vec2& at, const Vec2& outward, const std::string& name) {
  canvas.circle(at, 1.8, {0.35, kBlue, 0.0});
  canvas.line(at - Vec2(2.8, 0), at + Vec2(2.8, 0), {0.25, kBlue, 0.0});
  canvas.line(at - Vec2(0, 2.8), at + Vec2(0, 2.8), {0.25, kBlue, 0.0});
  // A capital is 0.7 of its size high, so this puts its middle on the line outwards.
  canvas.text(at + 4.6 * outward + Vec2(0, 1.4), name, {.size_mm = 4.0, .bold = true, .align = 0.5, .color = kBlue});
}

void draw_joint(Canvas& canvas, const Vec2& from, const Vec2& to, bool cut) {
  canvas.line(from, to, {0.3, kBlack, 1.2});
  if (!cut) return;
  for (const double part : {0.12, 0.25, 0.75, 0.88}) {
    const Vec2 at = from + part * (to - from);
    canvas.line(at + Vec2(-0.9, -0.9), at + Vec2(0.9, 0.9), {0.35, kRed, 0.0});
    canvas.line(at + Vec2(-0.9, 0.9), at + Vec2(0.9, -0.9), {0.35, kRed, 0.0});
  }
}

void draw_ground(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks) {
  std::array<design::Vec3, 3> flat;
  for (std::size_t k = 0; k < 3; ++k) flat[k] = {corners[k].x(), corners[k].y(), 0.0};
  const design::Outline shape = design::outline_of(flat, marks.corner_cut_mm);
  std::vector<Vec2> outline;
  for (const auto& p : shape.points()) outline.emplace_back(p.x(), p.y());
  canvas.fill(outline, color_of(marks.patch, 0.95));
  canvas.outline(outline, {0.05, kGrey, 0.0});  // A hairline is enough, because lines to cut or fold are drawn over it.
}

void draw_module(Canvas& canvas, const std::array<Vec2, 3>& corners, const ModuleMarks& marks) {
  const Vec2 center = center_of(corners);
  const double down = marks.up ? 1.0 : -1.0;
  canvas.text(center + Vec2(0, marks.up ? -2.0 : 5.2), marks.number, {.size_mm = 4.4, .bold = true, .align = 0.5});
  draw_strap(canvas, center + Vec2(0, down > 0 ? 0.4 : -3.8), fmt::format("L{}", marks.line), {marks.line});
  // The pads are ADD0L, ADD0H, ADD1L, ADD1H (design::address_strap).
  draw_strap(canvas, center + Vec2(0, down > 0 ? 3.6 : -0.6), fmt::format("{:02X}", layout::cdc_address(marks.address)),
             {marks.address & 1, 2 + (marks.address >> 1)});
  draw_ports(canvas, corners, marks.rotation);
  const auto side = static_cast<std::size_t>(marks.rotation);
  const Vec2 middle = (corners[side] + corners[(side + 1) % 3]) / 2.0, inwards = (center - middle).normalized();
  draw_arrow(canvas, middle - 2.6 * inwards, middle + 2.4 * inwards, kBlack);
}

}  // namespace triskin::sheet
