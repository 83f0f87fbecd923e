// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "motion_region.hpp"

namespace triskin::check {

/// States what two or three needs of a region say about its angles when their normals cancel: the translation drops
/// out, and cosine * cos(theta) + sine * sin(theta) >= constant remains.
struct AngleNeed {
  Interval cosine, sine, constant;
};

/// Bounds the modules that lie inside at one motion of a region by needs that contradict each other: modules that lie
/// inside nowhere, and disjoint pairs of modules that never lie inside together. Angles are halved until one
/// contradiction holds over each part, so that the sums are not linearized. Each thread needs its own object.
class JointBound {
 public:
  JointBound(const MotionRegion& region, const CandidateList& list);

  /// Drops the modules of the list that lie inside nowhere, then returns the bound.
  [[nodiscard]] int bound(CandidateList& list);

 private:
  [[nodiscard]] bool contradictory(std::span<const Need> a, std::span<const Need> b);
  void add_pair(const Need& a, const Need& b);
  void add_triples(std::span<const Need> needs);
  void add_sum(std::span<const Need* const> needs, std::span<const double> multipliers);
  [[nodiscard]] bool excluded(double low, double high, int halvings) const;
  [[nodiscard]] bool never_inside(std::span<const Need> needs);
  void drop_dead(CandidateList& list) const;
  [[nodiscard]] int disjoint_conflicts();
  bool rematch(std::size_t module, std::vector<bool>& asked);

  const MotionRegion& region_;
  std::vector<std::vector<Need>> needs_;  // The index is a module of the list.
  std::vector<bool> dead_;
  std::vector<AngleNeed> sums_;
  std::vector<std::vector<std::size_t>> rivals_;
  std::vector<int> partner_, colour_;
};

}  // namespace triskin::check
