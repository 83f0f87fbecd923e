// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "interval.hpp"
#include "proof_log.hpp"

namespace triskin::check {

inline constexpr double kModuleSide_mm = 30.0;

/// A shape of module and its grid, as the checker knows them.
struct ProofModule {
  /// The up module is given around its centre, with outward normals of unit length; the down one is its mirror image in
  /// the centre.
  std::vector<IntervalPoint> normal, corner;
  bool has_down = false;
  std::vector<Interval> offset;  ///< Each side is this far from the centre.
  double inradius_low_mm = 0.0,  ///< The least offset of a side, rounded down.
      circumradius_high_mm = 0.0;
  double min_pitch_mm = 0.0;     ///< Modules would overlap at a smaller pitch.
  Interval row_height;           ///< The height of a row is in pitches.
  double row_shift = 0.0;        ///< Each row is shifted by this many pitches.
  double period_high_rad = 0.0;  ///< The grid is its own image after a turn by slightly less than this.

  [[nodiscard]] Interval area_mm2() const;
  [[nodiscard]] IntervalPoint center(const ProofTile& tile, double pitch_mm) const;
};

/// Returns the module of a shape, with sides of 30 mm. Triangles may have their corners cut off, `corner_cut_mm` along
/// each side, 0 … kMaxProofCut_mm; other shapes ignore the cut. Thread-safe.
[[nodiscard]] ProofModule proof_module(ProofShape shape, double corner_cut_mm);
/// With a larger cut the short sides would be nearer to the centre than the long ones.
inline constexpr double kMaxProofCut_mm = 10.0;

}  // namespace triskin::check
