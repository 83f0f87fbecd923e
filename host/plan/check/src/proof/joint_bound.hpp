// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "motion_region.hpp"

namespace triskin::check {

/// States what two or three needs of a region say about its angles when their normals cancel: the translation drops
/// out, and cosine * cos(theta) + sine * sin(theta) >= constant remains.
struct AngleNeed {
  Interval cosine, sine, constant;
};

/// A need with by how much it is met at three angles, in rounded numbers that are never part of a bound.
struct SampledNeed {
  Need need;
  NeedSamples at;
};

/// The needs of one module that one edge causes by one normal.
struct NeedGroup {
  std::size_t module = 0;
  bool by_side = false;
  std::uint32_t edge = 0;
  double along_mm = 0.0;  ///< Where the module's centre lies along the edge, to the left of the normal.
  NeedSamples least;      ///< The least of all needs at each angle.
  [[nodiscard]] bool at_same_edge(const NeedGroup& other) const {
    return by_side == other.by_side && edge == other.edge && least.normal_x == other.least.normal_x &&
           least.normal_y == other.least.normal_y;
  }
};

/// Bounds the modules that lie inside at one motion of a region by needs that contradict each other: modules that lie
/// inside nowhere, disjoint pairs and larger groups of modules of which one lies inside at most, and sets of up to four
/// modules that never lie inside together. Angles are halved until one
/// contradiction holds over each part, so that the sums are not linearized. Pairs are looked for among modules that
/// face each other across two opposed edges, so the cost is O(n log n) for n modules. Each thread needs its own object.
class JointBound {
 public:
  JointBound(const MotionRegion& region, const CandidateList& list);

  /// Tells whether no more than `allowed` modules lie inside, and drops modules of the list that lie inside nowhere.
  [[nodiscard]] bool holds(CandidateList& list, int allowed);
  /// Returns how many pairs of modules were compared.
  [[nodiscard]] std::int64_t pairs_compared() const { return pairs_compared_; }

 private:
  using Needs = std::vector<SampledNeed>;
  [[nodiscard]] bool contradictory(std::size_t a, std::size_t b);
  void add_pairs(const Needs& a, const Needs& b);
  void add_worst_pairs(const Needs& a, const Needs& b);
  void add_triples(const Needs& needs);
  void add_sum(std::span<const SampledNeed* const> needs, std::span<const double> multipliers);
  [[nodiscard]] bool excluded_everywhere() const;
  [[nodiscard]] bool excluded(double low, double high, int halvings) const;
  [[nodiscard]] bool never_inside(std::size_t module);
  void drop_dead(CandidateList& list) const;
  void find_candidates();
  [[nodiscard]] std::vector<NeedGroup> groups() const;
  void compare(std::span<const NeedGroup> here, std::span<const NeedGroup> there);
  [[nodiscard]] int greedy_pairs(int wanted);
  [[nodiscard]] int most_pairs();
  [[nodiscard]] int excluded_in_groups() const;
  [[nodiscard]] bool exclude_each_other(std::size_t a, std::size_t b) const;
  [[nodiscard]] bool no_set_without(int drops, bool only_single) const;
  void find_rivals();
  void colour_rivals();
  bool rematch(std::size_t module, std::size_t root);

  const MotionRegion& region_;
  std::vector<Needs> needs_;  // The index is a module of the list.
  std::vector<IntervalPoint> centers_;
  std::vector<bool> dead_;
  std::vector<AngleNeed> sums_;
  std::vector<std::vector<std::size_t>> candidates_, rivals_;
  std::vector<int> partner_, colour_;
  std::vector<std::size_t> asked_for_;  // The last root that asked for the module, plus one.
  std::int64_t pairs_compared_ = 0;
};

}  // namespace triskin::check
