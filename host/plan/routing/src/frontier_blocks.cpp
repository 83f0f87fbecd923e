// SPDX-License-Identifier: GPL-3.0-or-later
#include "frontier_blocks.hpp"

#include <algorithm>
#include <utility>

namespace triskin::routing {
namespace {

FrontierOrder grow(const LocalGraph& g, const Numbers& nodes, const Table<int, bool>& inside, int start, long& cost) {
  FrontierOrder order;
  Numbers missing(g.node.size(), 0), border{start};
  Table<int, bool> placed(g.node.size(), false);
  for (const int v : nodes) {
    for (const int w : g.neighbour[v]) missing[v] += w >= 0 && inside[w] ? 1 : 0;
  }
  int frontier = 0;
  while (!border.empty()) {
    // The first is the change of the frontier, the second the place in the border.
    std::pair<int, std::size_t> best{9, 0};
    for (std::size_t k = 0; k < border.size(); ++k) {
      int change = missing[border[k]] > 0 ? 1 : 0;
      for (const int w : g.neighbour[border[k]]) change -= w >= 0 && placed[w] && missing[w] == 1 ? 1 : 0;
      best = std::min(best, {change, k});
    }
    const int v = border[best.second];
    border.erase(border.begin() + static_cast<std::ptrdiff_t>(best.second));
    placed[v] = true;
    order.nodes.push_back(v);
    for (const int w : g.neighbour[v]) {
      if (w < 0 || !inside[w]) continue;
      --missing[w];
      if (!placed[w] && std::ranges::count(border, w) == 0) border.push_back(w);
    }
    frontier += best.first;
    order.widest = std::max(order.widest, frontier + 1);
    cost += 1L << (2 * std::min(frontier, 20));
  }
  return order;
}

}  // namespace

FrontierOrder order_for_small_frontier(const LocalGraph& g, const Numbers& nodes) {
  Table<int, bool> inside(g.node.size(), false);
  for (const int v : nodes) inside[v] = true;
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
