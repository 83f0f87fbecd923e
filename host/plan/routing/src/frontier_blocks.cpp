// SPDX-License-Identifier: GPL-3.0-or-later
#include "frontier_blocks.hpp"

#include <algorithm>
#include <utility>

namespace triskin::routing {
namespace {

FrontierOrder grow(const LocalGraph& g, const std::vector<int>& nodes, const std::vector<bool>& inside, int start,
                   long& cost) {
  FrontierOrder order;
  std::vector<int> missing(at(g.size()), 0), border{start};
  std::vector<bool> placed(at(g.size()), false);
  for (const int v : nodes) {
    for (const int w : g.neighbour[at(v)]) missing[at(v)] += w >= 0 && inside[at(w)] ? 1 : 0;
  }
  int frontier = 0;
  while (!border.empty()) {
    // The first is the change of the frontier, the second the place in the border.
    std::pair<int, std::size_t> best{9, 0};
    for (std::size_t k = 0; k < border.size(); ++k) {
      int change = missing[at(border[k])] > 0 ? 1 : 0;
      for (const int w : g.neighbour[at(border[k])]) change -= w >= 0 && placed[at(w)] && missing[at(w)] == 1 ? 1 : 0;
      best = std::min(best, {change, k});
    }
    const int v = border[best.second];
    border.erase(border.begin() + static_cast<std::ptrdiff_t>(best.second));
    placed[at(v)] = true;
    order.nodes.push_back(v);
    for (const int w : g.neighbour[at(v)]) {
      if (w < 0 || !inside[at(w)]) continue;
      --missing[at(w)];
      if (!placed[at(w)] && std::ranges::count(border, w) == 0) border.push_back(w);
    }
    frontier += best.first;
    order.widest = std::max(order.widest, frontier + 1);
    cost += 1L << (2 * std::min(frontier, 20));
  }
  return order;
}

}  // namespace

FrontierOrder order_for_small_frontier(const LocalGraph& g, const std::vector<int>& nodes) {
  std::vector<bool> inside(at(g.size()), false);
  for (const int v : nodes) inside[at(v)] = true;
  const std::size_t step = std::max<std::size_t>(1, nodes.size() / 24);
  long least = -1;
  FrontierOrder best;
  for (std::size_t s = 0; s < nodes.size(); s += step) {
    long cost = 0;
    FrontierOrder order = grow(g, nodes, inside, nodes[s], cost);
    if (least >= 0 && cost >= least) continue;
    least = cost;
    best = std::move(order);
  }
  return best;
}

}  // namespace triskin::routing
