// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "net.hpp"
#include "triskin/base/disjoint_sets.hpp"

namespace triskin::lattice {

/// The relaxed price in two parts: controllers, and the jumpers and islands that join them.
struct RelaxedPrice {
  double controllers = 0.0, joining = 0.0;
  [[nodiscard]] double sum() const { return controllers + joining; }
};

/// Estimates the price of islands before they are wired. n connected modules count as p(n) = max(1, n / 16 + 15 / 32)
/// pieces, one for each controller. Jumpers can join islands of one group; a group of n modules in islands of n₁,
/// n₂ … has p(n) controllers and, as when wired, a jumper for each further piece: Σ p(nᵢ) - p(n). The numbers
/// are fractions, because a search that pays a whole controller for the next module never places it. `group[k]` ≥ 0
/// is that of island k. Cost: O(islands).
[[nodiscard]] RelaxedPrice relaxed_price(const std::vector<int>& sizes, const std::vector<int>& group,
                                         const Price& price);

/// Estimates the same with ⌈n / 16⌉ for p(n): the cost of the wiring if every island can be divided so that parts
/// of several fill one controller, and never more than the wiring costs. The search approaches a multiple of 16 by the
/// relaxed price and fills the last controller by this one. Cost: O(islands).
[[nodiscard]] double rounded_price(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price);

struct EstimatedPrice {
  RelaxedPrice relaxed;
  double rounded = 0.0;
};

/// Keeps both prices of a net up to date from its changes. Islands are in one group if two free sides lie within
/// `jumper_mm` and face each other. Each thread needs its own object. Cost: the changes since the last call, and a few
/// ns per module.
class NetPrice {
 public:
  NetPrice(const Price& price, double jumper_mm) : price_(price), jumper_mm_(jumper_mm) {}
  /// Prices the net of the last call after changes or, after forget(), any net. Clears its list of changes.
  [[nodiscard]] EstimatedPrice operator()(LatticeMesh& net);
  void forget() { knows_net_ = false; }

 private:
  void follow(LatticeMesh& net);
  void link(const LatticeMesh& net, int triangle);
  void unlink(int triangle);
  [[nodiscard]] bool can_be_joined(const LatticeMesh& net, int a, int b) const;

  Price price_;
  double jumper_mm_;
  bool knows_net_ = false;
  // Lists for each triangle those that have a free side opposite one of its own.
  std::vector<std::vector<int>> linked_;
  DisjointSets islands_;  // Joins the numbers of islands that jumpers can connect.
  std::vector<int> changed_, sizes_, group_;
};

}  // namespace triskin::lattice
