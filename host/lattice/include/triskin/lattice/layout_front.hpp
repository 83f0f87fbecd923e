// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "triskin/lattice/net.hpp"

namespace triskin::geometry::surface_lattice {

/// Layouts with up to so many modules fewer than the best are kept beside it.
inline constexpr int kFront = 12;

using NetCopy = std::shared_ptr<const LatticeMesh>;

/// A layout and what the growth takes it to be worth.
struct FoundLayout {
  NetCopy net;
  double value;
};

/// The most valuable layout found for each number of modules and of islands: the price of the growth is not that of the
/// wired layout, and islands are what the two see most differently. Together they have at most `max_modules` modules,
/// or are one layout: where there are more, the least valuable go. Work of one thread.
class LayoutFront {
 public:
  using Numbers = std::pair<int, int>;         // Numbers of modules and islands.
  static constexpr int kMaxModules = 200'000;  ///< So many modules take some 100 MB.
  explicit LayoutFront(int max_modules = kMaxModules) : max_modules_(max_modules) {}

  [[nodiscard]] bool would_keep(const LatticeMesh& net, double value) const;
  /// Keeps the layout where would_keep() says so. Cost: the number of layouts where some have to go.
  void keep(const NetCopy& net, double value);
  /// Layouts of fewer modules go.
  void forget_below(int modules);
  [[nodiscard]] const std::map<Numbers, FoundLayout>& found() const { return found_; }

 private:
  [[nodiscard]] std::map<Numbers, FoundLayout>::const_iterator min_valuable() const;

  int max_modules_, modules_ = 0;  // Both count the modules of all layouts together.
  std::map<Numbers, FoundLayout> found_;
};

/// Cheaper layouts made of one, `layouts` ≥ 1 of them at most: islands of up to sixteen modules go, the smallest
/// first, until `modules` are left or fewer; those with fixed modules stay. The one with fewest modules comes first.
/// The other end of the choice, where a search ends at many modules. Cost: O(n) a layout.
[[nodiscard]] std::vector<LatticeMesh> thinned(const LatticeMesh& net, int modules, std::size_t layouts);

}  // namespace triskin::geometry::surface_lattice
