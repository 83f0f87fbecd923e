// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <vector>

#include "chain.hpp"

namespace triskin::lattice {

/// Chains that change one layout together. In each round every chain works in a zone of its own; the zones are divided
/// anew each time, so that the band between two zones is reached in the next round. The first chain has the layout and
/// the schedule. A team of one is a chain alone.
class Team {
 public:
  /// Takes chains that were built; the best of their layouts becomes the team's.
  Team(const GrowthTask& task, std::deque<Chain>& chains, std::size_t first, std::size_t count);

  /// Gives every chain its zone. The caller must then run each chain and call merge().
  void divide_work();
  void merge();
  /// Takes over the layout of another team if it is better by more than the annealing would gain.
  void catch_up(const Chain& best);

 private:
  [[nodiscard]] Chain& chain(std::size_t k) const { return chains_[first_ + k]; }

  const GrowthTask& task_;
  std::deque<Chain>& chains_;
  std::size_t first_, count_;
  std::size_t working_ = 1;  // This many chains work in this round.
};

/// Divides the chains into teams of at most `most` ≥ 1; the last team gets the rest.
[[nodiscard]] std::vector<Team> teams_of(const GrowthTask& task, std::deque<Chain>& chains, int most);

}  // namespace triskin::lattice
