// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "net.hpp"

namespace triskin::lattice {

/// Layouts with up to this many modules fewer than the best are kept beside it.
inline constexpr int kFront = 12;

using NetCopy = std::shared_ptr<const LatticeMesh>;

/// A layout and its value as estimated by the growth.
struct FoundLayout {
  NetCopy net;
  double value;
};

/// Keeps the most valuable layout found for each number of modules and of islands. The price of the growth is not that
/// of the wired layout, and the two differ most about islands. All layouts together have at most `max_modules` modules
/// unless there is only one; the least valuable are dropped. Not thread-safe.
class LayoutFront {
 public:
  using Numbers = std::pair<int, int>;         // The first is the number of modules, the second that of islands.
  static constexpr int kMaxModules = 200'000;  ///< This many modules take some 100 MB.
  explicit LayoutFront(int max_modules = kMaxModules) : max_modules_(max_modules) {}

  [[nodiscard]] bool would_keep(const LatticeMesh& net, double value) const;
  /// Keeps the layout if would_keep() says so. Cost: the number of layouts if some must be dropped.
  void keep(const NetCopy& net, double value);
  /// Drops layouts with fewer modules.
  void forget_below(int modules);
  [[nodiscard]] const std::map<Numbers, FoundLayout>& found() const { return found_; }

 private:
  [[nodiscard]] std::map<Numbers, FoundLayout>::const_iterator min_valuable() const;

  int max_modules_, modules_ = 0;  // Both count the modules of all layouts together.
  std::map<Numbers, FoundLayout> found_;
};

/// Makes cheaper layouts from one, `layouts` ≥ 1 of them at most, for a search that ends at many modules: removes
/// islands of up to sixteen modules, the smallest first, until `modules` or fewer remain; islands with fixed modules
/// stay. The layout with fewest modules comes first. Cost: O(n) per layout.
[[nodiscard]] std::vector<LatticeMesh> thinned(const LatticeMesh& net, int modules, std::size_t layouts);

}  // namespace triskin::lattice
