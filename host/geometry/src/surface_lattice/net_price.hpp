// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "net.hpp"

namespace triskin::geometry::surface_lattice {

/// Price of islands before they are wired. Islands of one group can be joined by jumpers; a group of n modules in i
/// islands is counted as max(1, n / 16 + 15 / 32) controllers and i − 1 jumpers. Controllers are a fraction, because a
/// search that pays a whole one for the next module never places it. `group[k]` ≥ 0 of island k. Cost: O(islands).
[[nodiscard]] double relaxed_price(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price);

/// relaxed_price() of a net. Islands are in one group where two free sides lie within `jumper_mm` and face each other.
/// Keeps its buffers between calls; one object a thread. Cost: about 15 µs for 150 modules.
class NetPrice {
 public:
  NetPrice(const Price& price, double jumper_mm) : price_(price), jumper_mm_(jumper_mm) {}
  [[nodiscard]] double operator()(const LatticeNet& net);

 private:
  struct Side {
    double x;
    int island, triangle, side;
  };
  void group_islands(const LatticeNet& net);
  [[nodiscard]] int find(int island);

  Price price_;
  double jumper_mm_;
  std::vector<Side> sides_;
  std::vector<int> leader_, number_, sizes_, group_;
};

}  // namespace triskin::geometry::surface_lattice
