// SPDX-License-Identifier: GPL-3.0-or-later
// Implements Algorithm 1 of the paper (Section IV-B) with Definitions 5 to 8 and Theorems 1 and 2 (Section IV-A).
#include "triskin/placement/paper/algorithm1.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "paper/grid_frame.hpp"
#include "paper/pierced.hpp"
#include "paper/side_marks.hpp"

namespace triskin::placement::paper {
namespace {

// A point or stretch of the outline on one generating line. A point has low == high; consecutive vertices on the line
// form one stretch, which Definition 6 shrinks to a point.
struct Stretch {
  int line = 0;
  double low = 0.0, high = 0.0;  // Positions along the line are in sides.
};

}  // namespace

struct Algorithm1::State {
  GridFrame frame;
  Algorithm1Options options;
  SideMarks marks;
  std::vector<Stretch> cutting;  // These are the intersections 𝕀ᶜ of all lines of one direction.

  State(const Polygon& polygon, const Algorithm1Options& o) : frame(polygon, o.touch_mm), options(o) {}

  void evaluate(const PivotedPlacement& at) {
    frame.move(at);
    marks.reset(frame);
    for (std::size_t direction = 0; direction < kDirections; ++direction) {
      cutting.clear();
      for (std::size_t ring = 0; ring < frame.rings(); ++ring)
        intersect(direction, frame.ring_begin(ring), frame.ring_begin(ring + 1));
      mark_intervals(direction);
    }
    if (options.reject_pierced) reject_pierced(frame, marks);
  }

  // Collects the cutting intersections of one ring with the lines of one direction (Definition 6), and marks the sides
  // that lie on its edges.
  void intersect(std::size_t direction, std::size_t first, std::size_t last) {
    const std::vector<double>&across = frame.across(direction), &along = frame.along(direction);
    std::size_t before = last - 1;
    for (std::size_t k = first; k < last; before = k++) {
      const double from = across[before], to = across[k];
      if (from == to) continue;
      const auto [low, high] = std::minmax(from, to);
      for (double line = std::floor(low) + 1.0; line < high; line += 1.0) {
        const double at = along[before] + (line - from) / (to - from) * (along[k] - along[before]);
        cutting.push_back({static_cast<int>(line), at, at});
      }
      if (to == std::floor(to)) visit_stretch(direction, first, last, k);
    }
  }

  // Handles the stretch on a line that begins at vertex `start`; the vertex before it is beside the line.
  void visit_stretch(std::size_t direction, std::size_t first, std::size_t last, std::size_t start) {
    const std::vector<double>&across = frame.across(direction), &along = frame.along(direction);
    const double line = across[start];
    const bool was_above = across[start == first ? last - 1 : start - 1] > line;
    Stretch s{static_cast<int>(line), along[start], along[start]};
    std::size_t k = start;
    for (;;) {
      const std::size_t next = k + 1 == last ? first : k + 1;
      if (across[next] != line) {
        if ((across[next] > line) != was_above) cutting.push_back(s);
        break;
      }
      if (options.sides == ContainedSides::kTheorem2)
        mark_between(direction, s.line, std::min(along[k], along[next]), std::max(along[k], along[next]));
      s.low = std::min(s.low, along[next]);
      s.high = std::max(s.high, along[next]);
      k = next;
    }
    if (options.sides == ContainedSides::kDefinition5) mark_between(direction, s.line, s.low, s.high);
  }

  // Theorem 1: of the sorted cutting intersections of a line, each odd one and the next bound a containment interval.
  // By Definition 5 the stretches at its ends belong to it; taken literally they are points, and the interval ends
  // there.
  void mark_intervals(std::size_t direction) {
    std::ranges::sort(cutting, {}, [](const Stretch& s) { return std::tuple(s.line, s.low, s.high); });
    const bool whole = options.sides == ContainedSides::kDefinition5;
    for (std::size_t k = 0; k + 1 < cutting.size(); k += 2) {
      const Stretch &begin = cutting[k], &end = cutting[k + 1];
      mark_between(direction, begin.line, whole ? begin.low : begin.high, whole ? end.high : end.low);
    }
  }

  void mark_between(std::size_t direction, int line, double low, double high) {
    const int last = static_cast<int>(std::floor(high + frame.touch_along()));
    for (int at = static_cast<int>(std::ceil(low - frame.touch_along())); at < last; ++at)
      marks.mark(direction, line, at);
  }
};

Algorithm1::Algorithm1(const Polygon& polygon, const Algorithm1Options& options) {
  const bool in_range = options.touch_mm >= 0.0 && options.touch_mm <= 1.0;
  if (!in_range) throw std::invalid_argument("Algorithm 1: the touching distance must be in 0 … 1 mm");
  state_ = std::make_unique<State>(polygon, options);
}
Algorithm1::~Algorithm1() = default;
Algorithm1::Algorithm1(Algorithm1&&) noexcept = default;
Algorithm1& Algorithm1::operator=(Algorithm1&&) noexcept = default;

int Algorithm1::count(const PivotedPlacement& placement) {
  state_->evaluate(placement);
  return state_->marks.count();
}

std::vector<Tile> Algorithm1::patch(const PivotedPlacement& placement) {
  state_->evaluate(placement);
  return state_->marks.contained();
}

}  // namespace triskin::placement::paper
