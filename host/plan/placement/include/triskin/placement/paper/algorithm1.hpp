// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "triskin/design/design_types.hpp"

/// Implements the reference paper literally (docs/paper.md): Anghinolfi, Cannata, Mastrogiovanni, Nattero, Paolucci,
/// "On the Problem of the Automated Design of Large-Scale Robot Skin", T-ASE 2013.
namespace triskin::placement::paper {

/// A placement ρ(P) (Section IV-A, Definition 1) by its four parameters (x, y, θ, v): q = R(θ)*(p - p_v) + p_v + (x,
/// y).
struct PivotedPlacement {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double theta_rad = 0.0;
  /// The index refers to the counter-clockwise outer ring; −1 stands for the origin of the polygon's frame.
  int vertex = -1;
};

/// Returns the same motion without pivot. Throws std::out_of_range when `vertex` is no vertex.
[[nodiscard]] Placement without_pivot(const Polygon& polygon, const PivotedPlacement& placement);

/// Selects which module sides count as contained. The paper states the rule three times, and the three differ if edges
/// of the polygon lie on a generating line.
enum class ContainedSides : std::uint8_t {
  kDefinition5,         ///< An interval of the line in cl(P) is one segment together with the edges that continue it.
  kTheorem2,            ///< The theorem is taken literally: a side lies in one containment interval or on one edge.
  kContainmentInterval  ///< As in the listing (lines 5 to 12), only containment intervals count.
};

struct Algorithm1Options {
  ContainedSides sides = ContainedSides::kDefinition5;
  /// Below this distance a vertex touches a generating line, and an end of an interval touches a node. The value is far
  /// above the rounding of coordinates, so that anything laid on a line or node by construction is known to touch it.
  double touch_mm = 5e-7;
  /// Goes beyond the paper: a module with a vertex of the polygon in its interior, or one that is a hole, is not
  /// contained. Three contained sides cannot tell this for polygons with holes or with cracks of zero width.
  bool reject_pierced = false;
};

/// Runs Algorithm 1 (Section IV-B): finds the patch ℙ of one placement and its size, the value of the objective
/// function ℭ (Definitions 2 and 3). On each generating line (0°, 60°, 300°) the cutting intersections (Definition
/// 6), sorted, pair into containment intervals (Definitions 7 and 8, Theorem 1); a module side is contained when it
/// lies in one or on an edge on the line (Theorem 2), a module when its three sides are (Definition 5, Conditions 1 and
/// 2). Rings after the first are treated like the first, by parity. Memory is kept between calls, so each thread needs
/// its own object. Cost of a call: O(edges · lines that they cross + sides of the window). Consecutive calls with the
/// same angle do not turn the polygon again.
class Algorithm1 {
 public:
  /// `polygon` must be normalized (polygon_io.hpp). Throws std::invalid_argument unless 0 ≤ touch_mm ≤ 1.
  explicit Algorithm1(const Polygon& polygon, const Algorithm1Options& options = {});
  ~Algorithm1();
  /// Takes over the polygon and the memory of another; never throws. The other can only be assigned to or destroyed.
  Algorithm1(Algorithm1&&) noexcept;
  /// Takes over the polygon and the memory of another, like the constructor; never throws.
  Algorithm1& operator=(Algorithm1&&) noexcept;

  /// Returns F, the number of modules. Throws std::out_of_range when `placement.vertex` is no vertex.
  [[nodiscard]] int count(const PivotedPlacement& placement);
  /// Returns ℙ, the contained modules, sorted. Throws std::out_of_range as count().
  [[nodiscard]] std::vector<Tile> patch(const PivotedPlacement& placement);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Selects how CGAL is used: Section VI names the library, but no kernel.
struct CgalUse {
  bool exact_constructions = false;
  /// True skips an edge with both ends on one side of a line before its intersection is computed. The paper computes
  /// all intersections first and sorts them out afterwards (Section IV-B, Definition 6).
  bool sides_first = false;
};

/// Finds the same patch as in the listing: placement, intersections and comparisons in a kernel of CGAL, every line
/// against every edge, every interval against every side of its line. Throws std::out_of_range when the placement's
/// vertex does not exist. Cost: O(lines · (edges + intervals · sides of a line)).
[[nodiscard]] std::vector<Tile> algorithm1_cgal(const Polygon& polygon, const PivotedPlacement& placement,
                                                const CgalUse& use = {}, const Algorithm1Options& options = {});

}  // namespace triskin::placement::paper
