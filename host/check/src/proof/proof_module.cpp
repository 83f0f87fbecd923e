// SPDX-License-Identifier: GPL-3.0-or-later
#include "proof_module.hpp"

namespace triskin::check {
namespace {

const Interval kHalfRoot3{0.86602540378443859, 0.86602540378443871};  // √3/2 lies between these two neighbours
const Interval kThird{1.0 / 3.0 - 1e-16, 1.0 / 3.0 + 1e-16};
constexpr double kSixth_rad = 1.0471975511965979, kQuarter_rad = 1.5707963267948968;  // a hair above 60° and 90°
constexpr double kHalfSide_mm = 0.5 * kModuleSide_mm;

ProofModule triangle() {
  const Interval inradius = Interval(kModuleSide_mm) * kHalfRoot3 * kThird;
  return {.normal = {{0.0, -1.0}, {kHalfRoot3, 0.5}, {-kHalfRoot3, 0.5}},
          .corner = {{-kHalfSide_mm, -inradius}, {kHalfSide_mm, -inradius}, {0.0, inradius + inradius}},
          .has_down = true,
          .inradius = inradius,
          .inradius_low_mm = 8.66,
          .circumradius_high_mm = 17.321,
          .least_pitch_mm = kModuleSide_mm,
          .row_height = kHalfRoot3,
          .row_shift = 0.5,
          .period_high_rad = kSixth_rad};
}

ProofModule square() {
  return {.normal = {{0.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}},
          .corner = {{-kHalfSide_mm, -kHalfSide_mm},
                     {kHalfSide_mm, -kHalfSide_mm},
                     {kHalfSide_mm, kHalfSide_mm},
                     {-kHalfSide_mm, kHalfSide_mm}},
          .has_down = false,
          .inradius = kHalfSide_mm,
          .inradius_low_mm = 15.0,
          .circumradius_high_mm = 21.214,
          .least_pitch_mm = kModuleSide_mm,
          .row_height = 1.0,
          .row_shift = 0.0,
          .period_high_rad = kQuarter_rad};
}

// Corners above and below, sides left and right.
ProofModule hexagon() {
  const Interval inradius = Interval(kModuleSide_mm) * kHalfRoot3;
  return {.normal =
              {{0.5, -kHalfRoot3}, {1.0, 0.0}, {0.5, kHalfRoot3}, {-0.5, kHalfRoot3}, {-1.0, 0.0}, {-0.5, -kHalfRoot3}},
          .corner = {{0.0, -kModuleSide_mm},
                     {inradius, -kHalfSide_mm},
                     {inradius, kHalfSide_mm},
                     {0.0, kModuleSide_mm},
                     {-inradius, kHalfSide_mm},
                     {-inradius, -kHalfSide_mm}},
          .has_down = false,
          .inradius = inradius,
          .inradius_low_mm = 25.98,
          .circumradius_high_mm = 30.001,
          .least_pitch_mm = 51.9615242270663,
          .row_height = kHalfRoot3,
          .row_shift = 0.5,
          .period_high_rad = kSixth_rad};
}

}  // namespace

IntervalPoint ProofModule::center(const ProofTile& t, double pitch_mm) const {
  const Interval pitch(pitch_mm);
  if (!has_down) return {pitch * Interval(t.i + row_shift * t.j + 0.5), pitch * row_height * Interval(t.j + 0.5)};
  const Interval row = Interval(t.j) + (t.up ? kThird : kThird + kThird);
  return {pitch * Interval(t.i + row_shift * t.j + (t.up ? 0.5 : 1.0)), pitch * row_height * row};
}

const ProofModule& proof_module(ProofShape shape) {
  static const ProofModule kTriangle = triangle(), kSquare = square(), kHexagon = hexagon();
  return shape == ProofShape::kTriangle ? kTriangle : shape == ProofShape::kSquare ? kSquare : kHexagon;
}

}  // namespace triskin::check
