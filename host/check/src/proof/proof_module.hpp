// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "interval.hpp"
#include "proof_log.hpp"

namespace triskin::check {

inline constexpr double kModuleSide_mm = 30.0;

/// A shape of module and its grid, as the checker knows them.
struct ProofModule {
  /// Up module around its centre, outward and of unit length; the down one is its mirror image in the centre.
  std::vector<IntervalPoint> normal, corner;
  bool has_down = false;
  std::vector<Interval> offset;  ///< Each is the offset of a side from the centre.
  double inradius_low_mm = 0.0,  ///< It is the least offset.
      circumradius_high_mm = 0.0;
  double min_pitch_mm = 0.0;     ///< Modules would overlap below it.
  Interval row_height;           ///< It is the height of a row in pitches.
  double row_shift = 0.0;        ///< Each row is shifted by this in pitches.
  double period_high_rad = 0.0;  ///< The grid is its own image after this turn, a hair less.

  [[nodiscard]] IntervalPoint center(const ProofTile& tile, double pitch_mm) const;
};

/// The module of a shape, with sides of 30 mm. Of triangles the corners may be cut off, `corner_cut_mm` along each
/// side, 0 … kMaxProofCut_mm; of the others the cut is not looked at. Any number of threads.
[[nodiscard]] ProofModule proof_module(ProofShape shape, double corner_cut_mm);
/// With a larger cut the short sides would come nearer to the centre than the long ones.
inline constexpr double kMaxProofCut_mm = 10.0;

}  // namespace triskin::check
