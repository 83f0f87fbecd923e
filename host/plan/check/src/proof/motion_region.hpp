// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <deque>
#include <vector>

#include "proof_module.hpp"

namespace triskin::check {

/// An edge of the polygon relative to the pivot.
struct ProofEdge {
  std::array<IntervalPoint, 2> end;
  Interval offset;         ///< The offset is the left normal, which is not of unit length, times the end.
  double length_mm = 0.0;  ///< The value is an upper bound of the length.
};

/// A module near the outline, with its edges as a range of indices.
struct Candidate {
  ProofTile tile;
  IntervalPoint center;
  std::uint32_t first = 0, count = 0;
  bool inside = false;  ///< True if the centre is known to lie inside over the whole region.
};
struct CandidateList {
  std::vector<Candidate> tiles;
  std::vector<std::uint32_t> edges;
  int certain = 0;  ///< This many modules lie inside whatever the motion.
  [[nodiscard]] int bound() const { return certain + static_cast<int>(tiles.size()); }
};

/// States what a module needs in order to lie inside, whichever way it keeps clear of the edge, at every motion of a
/// region: normal . R(-theta) (point - t) >= constant for a point of the module and the edge's line, and by a side of
/// the module normal . (R(theta) point + t) >= constant for an end of the edge.
struct Need {
  bool by_side = false;
  std::uint32_t edge = 0;
  IntervalPoint normal, point;  ///< The normal has about unit length.
  Interval constant;
  double farthest_mm = 0.0;  ///< The normal is multiplied with vectors of at most this length.
};

/// By how much a need is met at the least, middle and largest angle of its region, with the translation at the middle,
/// in rounded numbers: a reason to look for a contradiction, never part of a bound.
inline constexpr std::size_t kSampledAngles = 3;
struct NeedSamples {
  double normal_x = 0.0, normal_y = 0.0;  ///< The normal at the middle angle, in the frame of the grid.
  std::array<double, kSampledAngles> excess_mm{};
};

/// The excess of a need over a region, in rounded numbers, without curvature: excess + Σ by_u[k]·u[k], where u runs
/// from −1 to 1 along x, y and the angle.
struct NeedChange {
  double excess_mm = 0.0;
  std::array<double, 3> by_u_mm{};
};
struct WeightedNeed {
  const Need* need = nullptr;
  double weight = 0.0;
};

/// Returns a length, rounded up.
inline double length_of(double x, double y) {
  return std::sqrt(x * x + y * y) * (1.0 + 1e-12);
}

/// Holds the polygon and the claims in the checker's own terms.
class ProofPolygon {
 public:
  ProofPolygon(const std::vector<std::array<PlanePoint, 2>>& edges, const PlanePoint& pivot, const ProofModule& module,
               double pitch_mm);

  [[nodiscard]] const std::vector<ProofEdge>& edges() const { return edges_; }
  [[nodiscard]] const ProofModule& module() const { return module_; }
  [[nodiscard]] double pitch_mm() const { return pitch_; }
  [[nodiscard]] double radius_mm() const { return radius_; }
  [[nodiscard]] IntervalPoint center_of(const ProofTile& tile) const { return module_.center(tile, pitch_); }
  /// Tests by even-odd rule whether a point in the polygon's frame is inside, in plain doubles: only for points that
  /// are far from every edge.
  [[nodiscard]] bool contains(double x, double y) const;

 private:
  std::vector<ProofEdge> edges_;
  std::vector<std::vector<std::uint32_t>> slabs_;
  double slab_low_ = 0.0, slab_height_ = 1.0;
  const ProofModule& module_;
  double pitch_;
  double radius_ = 0.0;
};

/// Covers all motions of a box and decides for modules and edges what holds for every one of them. Remembers the edges
/// that it moved, so each thread needs its own object.
class MotionRegion {
 public:
  MotionRegion(const ProofPolygon& polygon, const ProofBox& box);

  /// Returns how far a point of the polygon moves inside the region, in mm, at most.
  [[nodiscard]] double reach_mm() const { return reach_; }
  /// Returns every module that may lie inside for some motion.
  [[nodiscard]] CandidateList all() const;
  /// Drops modules that cannot lie inside and edges that cannot cut.
  [[nodiscard]] CandidateList filtered(const CandidateList& list) const;
  /// Returns the range of angles of the region, rad, none left out.
  [[nodiscard]] std::array<double, 2> angles() const { return {theta_ - half_theta_, theta_ + half_theta_}; }
  /// Adds the needs of the module that one edge causes.
  void add_needs(const Candidate& module, std::uint32_t edge, std::vector<Need>& needs) const;
  [[nodiscard]] NeedSamples samples(const Need& need) const;
  [[nodiscard]] NeedChange change(const Need& need) const;
  /// Returns how far a point of the grid lies along a direction of the grid, from the middle of the region.
  [[nodiscard]] double along_mm(double x, double y, const IntervalPoint& point) const {
    return x * (middle(point.x) - x_) + y * (middle(point.y) - y_);
  }
  /// Returns true if no motion of the region meets the need.
  [[nodiscard]] bool never_met(const Need& need) const;
  /// Returns true if at every motion of the region the weighted sum of the needs' excesses is negative, so that one of
  /// them at least is not met. Weights must not be negative.
  [[nodiscard]] bool never_met_together(const std::vector<WeightedNeed>& needs) const;
  /// Returns true if the module lies inside and overhangs by no more than `tolerance_mm`. The region must be one
  /// motion.
  [[nodiscard]] bool holds(const ProofTile& tile, double tolerance_mm) const;

 private:
  enum class Verdict { kNever, kMay, kAlways };
  struct Moved {
    // Values are taken at the middle, the derivative by the angle over the region.
    std::array<IntervalPoint, 2> end, end_turn;
    IntervalPoint normal, normal_range, normal_turn;
  };
  /// Lists the ways in which a module can keep clear of an edge somewhere in the region.
  struct Ways {
    bool left = true, right = true, always = false;
    std::vector<std::size_t> sides;
  };
  [[nodiscard]] const Moved& moved(std::uint32_t edge) const;
  [[nodiscard]] Moved newly_moved(const ProofEdge& edge) const;
  [[nodiscard]] Verdict cuts(const IntervalPoint& center, bool up, std::uint32_t edge, double allowance_mm) const;
  [[nodiscard]] Verdict side_frees(const IntervalPoint& center, double sign, const Moved& m, double allowance_mm) const;
  [[nodiscard]] Verdict one_side_frees(std::size_t side, const IntervalPoint& center, double sign, const Moved& m,
                                       double allowance_mm) const;
  [[nodiscard]] Ways line_ways(const IntervalPoint& center, double sign, const ProofEdge& edge, const Moved& m,
                               double allowance_mm) const;
  // The sum of needs as a function of the angle, with the normals by which the translation counts.
  struct NeedSum {
    Interval cosine, sine, constant;
    IntervalPoint line_normal, side_normal;
  };
  [[nodiscard]] bool negative(const NeedSum& sum, double low, double high, int halvings) const;
  [[nodiscard]] Need line_need(std::uint32_t edge, double turn, const IntervalPoint& point) const;
  void add_side_needs(const Candidate& module, std::uint32_t edge, std::size_t side, std::vector<Need>& needs) const;
  void add_needs_over(const Candidate& module, std::uint32_t edge, double turn, std::vector<Need>& needs) const;
  struct Span {
    double low = 1e300, high = -1e300;
  };
  [[nodiscard]] std::vector<Span> row_spans(double first_y, double row_height, std::size_t rows) const;
  [[nodiscard]] double distance_mm(const IntervalPoint& center, const ProofEdge& edge) const;
  [[nodiscard]] bool center_inside(const IntervalPoint& center) const;

  const ProofPolygon& polygon_;
  double x_, y_, theta_, half_x_, half_y_, half_theta_, reach_;
  double plain_cosine_, plain_sine_;
  std::array<std::array<double, 2>, kSampledAngles> sampled_;  // Cosine and sine of the sampled angles.
  Interval cosine_, sine_, cosine_range_, sine_range_;
  static constexpr std::uint32_t kNotMoved = 0xffffffff;
  mutable std::vector<std::uint32_t> place_of_;  // Where `moved_` has each edge.
  mutable std::deque<Moved> moved_;              // References to its elements stay valid while it grows.
};

}  // namespace triskin::check
