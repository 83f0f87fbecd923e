// SPDX-License-Identifier: GPL-3.0-or-later
#include "clearance.hpp"

#include <algorithm>
#include <array>

#include "branch_and_bound.hpp"
#include "evaluator.hpp"

namespace triskin::geometry {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kMostStarts = 3;
constexpr double kStartsMayStandOver_mm = 1e-2;

// Precision of the answer.
double more(double clearance) { return std::max(5e-3, 0.02 * std::abs(clearance)); }

// Makes the best of a motion that holds `modules` tiles: the inset at which they still fit, raised by axis steps.
class ClearanceAscent {
 public:
  ClearanceAscent(const PreparedPolygon& polygon, const TileGrid& grid, int modules)
      : polygon_(polygon), evaluator_(polygon, grid), inradius_(grid.inradius_mm), modules_(modules) {}

  /// The `n` motions with the largest clearance.
  std::vector<Motion> most_promising(const std::vector<Motion>& motions, std::size_t n, double least) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = motions.size(); k-- > 0;) {
      if (holds(motions[k], least)) order.emplace_back(raise(motions[k], least), k);
    }
    std::ranges::sort(order, std::greater<>());
    std::vector<Motion> best;
    for (std::size_t k = 0; k < std::min(n, order.size()); ++k) best.push_back(motions[order[k].second]);
    return best;
  }

  double climb(Motion& motion, double clearance) {
    if (!holds(motion, clearance)) return -inradius_;
    clearance = raise(motion, clearance);
    for (double step = 1.0; step > 1e-4; step *= 0.5) {
      for (bool better = true; better;) {
        better = false;
        for (int k = 0; k < 18; ++k) {
          const Motion next = stepped(motion, step, k);
          if (!holds(next, clearance + 0.1 * step)) continue;
          motion = next;
          clearance = raise(motion, clearance + 0.1 * step);
          better = true;
        }
      }
    }
    return clearance;
  }

 private:
  bool holds(const Motion& m, double inset) { return evaluator_.count(m, inset) >= modules_; }

  // Largest inset at this motion, to 0.1 µm.
  double raise(const Motion& m, double low) {
    double high = inradius_;
    while (high - low > 1e-4) {
      const double middle = 0.5 * (low + high);
      (holds(m, middle) ? low : high) = middle;
    }
    return low;
  }

  // The six axis steps and the twelve diagonal ones.
  [[nodiscard]] Motion stepped(const Motion& m, double step, int k) const {
    static constexpr std::array<std::array<int, 3>, 9> kSteps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}};
    const auto& s = kSteps[static_cast<std::size_t>(k / 2)];
    const double d = k % 2 == 0 ? step : -step;
    return {m.x + d * s[0], m.y + d * s[1], m.theta + d * s[2] / std::max(1.0, polygon_.radius_mm)};
  }

  const PreparedPolygon& polygon_;
  Evaluator evaluator_;
  double inradius_;
  int modules_;
};

}  // namespace

Clearance largest_clearance(const PreparedPolygon& polygon, const TileGrid& grid, const ClearanceGoal& goal, const ProgressSink& progress) {
  ClearanceAscent ascent(polygon, grid, goal.modules);
  Clearance best;
  best.inset_mm = goal.least_inset_mm;
  best.bound_mm = goal.most_inset_mm;
  const auto climb = [&](Motion at, double from) {
    const double reached = ascent.climb(at, from);
    if (reached < from || (best.found && reached <= best.inset_mm)) return;
    best.found = true;
    best.inset_mm = reached;
    best.motion = at;
  };
  for (const Motion& start : ascent.most_promising(goal.starts, kMostStarts, goal.least_inset_mm - kStartsMayStandOver_mm)) climb(start, goal.least_inset_mm);
  for (bool open = true; open && Clock::now() < goal.deadline;) {
    const auto next = [&] { return best.found ? best.inset_mm + more(best.inset_mm) : best.inset_mm; };
    const SearchGoal search{.inset_mm = next(), .tolerance_mm = 0.5 * more(best.inset_mm), .known = goal.modules - 1,
                            .raise = [&](const Motion& found) {
                              climb(found, next() - 0.5 * more(best.inset_mm));
                              return std::array{next(), 0.5 * more(best.inset_mm)};
                            },
                            .last_inset_mm = std::min(best.inset_mm + std::abs(best.inset_mm) + 0.1, goal.most_inset_mm), .threads = goal.threads, .deadline = goal.deadline};
    const SearchResult found = branch_and_bound(polygon, grid, search, progress);
    best.cells += found.cells;
    best.evaluations += found.evaluations;
    open = next() > search.last_inset_mm && search.last_inset_mm < goal.most_inset_mm;
    if (found.upper_bound < goal.modules) best.bound_mm = next();
  }
  return best;
}

}  // namespace triskin::geometry
