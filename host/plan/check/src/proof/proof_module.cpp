// SPDX-License-Identifier: GPL-3.0-or-later
#include "proof_module.hpp"

namespace triskin::check {
namespace {

const Interval kHalfRoot3{0.86602540378443859, 0.86602540378443871};  // √3/2 lies between these two neighbours.
const Interval kThird{1.0 / 3.0 - 1e-16, 1.0 / 3.0 + 1e-16};
// Both are slightly above 60° and 90°.
constexpr double kSixth_rad = 1.0471975511965979, kQuarter_rad = 1.5707963267948968;
constexpr double kHalfSide_mm = 0.5 * kModuleSide_mm;

ProofModule triangle() {
  const Interval inradius = Interval(kModuleSide_mm) * kHalfRoot3 * kThird;
  return {.normal = {{0.0, -1.0}, {kHalfRoot3, 0.5}, {-kHalfRoot3, 0.5}},
          .corner = {{-kHalfSide_mm, -inradius}, {kHalfSide_mm, -inradius}, {0.0, inradius + inradius}},
          .has_down = true,
          .offset = {inradius, inradius, inradius},
          .inradius_low_mm = 8.66,
          .circumradius_high_mm = 17.321,
          .min_pitch_mm = kModuleSide_mm,
          .row_height = kHalfRoot3,
          .row_shift = 0.5,
          .period_high_rad = kSixth_rad};
}

// Each corner becomes two, on the sides that meet there, with a side between them: its normal points from the centre to
// the removed corner, whose distance is 2/3 of the height.
void cut_corners(ProofModule& module, double cut_mm) {
  const Interval part = Interval(cut_mm) * Interval(1.0 / kModuleSide_mm - 1e-17, 1.0 / kModuleSide_mm + 1e-17);
  const std::vector<IntervalPoint> whole = std::move(module.corner);
  const auto shifted = [&part](const IntervalPoint& from, const IntervalPoint& to) {
    return IntervalPoint{from.x + part * (to.x - from.x), from.y + part * (to.y - from.y)};
  };
  const Interval far = Interval(kModuleSide_mm) * kHalfRoot3 * (kThird + kThird) - Interval(cut_mm) * kHalfRoot3;
  module.corner.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    module.corner.push_back(shifted(whole[k], whole[(k + 1) % 3]));
    module.corner.push_back(shifted(whole[(k + 1) % 3], whole[k]));
  }
  for (const IntervalPoint& n : {IntervalPoint{-kHalfRoot3, -0.5}, {kHalfRoot3, -0.5}, {0.0, 1.0}}) {
    module.normal.push_back(n);
    module.offset.push_back(far);
  }
}

ProofModule square() {
  return {.normal = {{0.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}},
          .corner = {{-kHalfSide_mm, -kHalfSide_mm},
                     {kHalfSide_mm, -kHalfSide_mm},
                     {kHalfSide_mm, kHalfSide_mm},
                     {-kHalfSide_mm, kHalfSide_mm}},
          .has_down = false,
          .offset = std::vector<Interval>(4, kHalfSide_mm),
          .inradius_low_mm = 15.0,
          .circumradius_high_mm = 21.214,
          .min_pitch_mm = kModuleSide_mm,
          .row_height = 1.0,
          .row_shift = 0.0,
          .period_high_rad = kQuarter_rad};
}

// The corners are above and below, the sides left and right.
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
          .offset = std::vector<Interval>(6, inradius),
          .inradius_low_mm = 25.98,
          .circumradius_high_mm = 30.001,
          .min_pitch_mm = 51.9615242270663,
          .row_height = kHalfRoot3,
          .row_shift = 0.5,
          .period_high_rad = kSixth_rad};
}

}  // namespace

Interval ProofModule::area_mm2() const {
  Interval twice;
  for (std::size_t k = 0; k < corner.size(); ++k) {
    const IntervalPoint &a = corner[k], &b = corner[(k + 1) % corner.size()];
    twice = twice + (a.x * b.y - a.y * b.x);
  }
  return Interval(0.5) * twice;
}

IntervalPoint ProofModule::center(const ProofTile& t, double pitch_mm) const {
  const Interval pitch(pitch_mm);
  if (!has_down) return {pitch * Interval(t.i + row_shift * t.j + 0.5), pitch * row_height * Interval(t.j + 0.5)};
  const Interval row = Interval(t.j) + (t.up ? kThird : kThird + kThird);
  return {pitch * Interval(t.i + row_shift * t.j + (t.up ? 0.5 : 1.0)), pitch * row_height * row};
}

ProofModule proof_module(ProofShape shape, double corner_cut_mm) {
  if (shape == ProofShape::kSquare) return square();
  if (shape == ProofShape::kHexagon) return hexagon();
  ProofModule module = triangle();
  if (corner_cut_mm > 0.0) cut_corners(module, corner_cut_mm);
  return module;
}

}  // namespace triskin::check
