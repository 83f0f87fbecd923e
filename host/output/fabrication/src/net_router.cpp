// SPDX-License-Identifier: GPL-3.0-or-later
#include "net_router.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <stdexcept>

#include "triskin/base/index.hpp"

namespace triskin::fabrication {
namespace {

constexpr int kRounds = 150;
// Every so many rounds all nets are routed anew, not only those in dispute, so that a free one makes room.
constexpr int kAllEvery = 8;
constexpr float kDiagonal = 1.4142F, kHoleCost = 12.0F, kFirstPressure = 0.5F, kPressureGrowth = 1.1F;
constexpr float kHistory = 1.0F;
constexpr float kTurnCost = 0.1F;  // Of two paths of one length, the one with fewer turns is taken.
// Squared distances in steps of the grid, up to which copper of two nets is too near: 0.2 mm between the middles of two
// tracks, 0.35 mm between a track and a hole, 0.5 mm between two holes.
constexpr int kTrackTrack = 3, kTrackHole = 10, kHoleHole = 20;

// Calls use(node, is_hole) for the nodes of a path; from the node before, a hole leads to another layer of the same
// place.
template <typename Use>
void for_nodes(const RouteGrid& grid, const NetPath& path, Use use) {
  const auto place = [&](std::size_t k) { return path.nodes[k] % grid.nodes_per_layer(); };
  for (std::size_t k = 0; k < path.nodes.size(); ++k) use(path.nodes[k], k > 0 && place(k - 1) == place(k));
}

// Counts, for each node, the nets whose copper forbids it to others.
class Congestion {
 public:
  explicit Congestion(const RouteGrid& grid)
      : grid_(grid),
        track_(at(kCopperLayers * grid.nodes_per_layer())),
        hole_(at(grid.nodes_per_layer())),
        stamp_(track_.size() + hole_.size(), 0) {}

  void change(const std::vector<NetPath>& paths, int by) {
    ++now_;
    for (const NetPath& path : paths) {
      for_nodes(grid_, path, [&](int node, bool is_hole) {
        const int layer = node / grid_.nodes_per_layer(), place = node % grid_.nodes_per_layer();
        around(place, kTrackTrack, [&](int p) { mark(layer, p, by); });
        around(place, kTrackHole, [&](int p) { mark_hole(p, by); });
        if (!is_hole) return;
        around(place, kTrackHole, [&](int p) {
          for (int l = 0; l < kCopperLayers; ++l) mark(l, p, by);
        });
        around(place, kHoleHole, [&](int p) { mark_hole(p, by); });
      });
    }
  }

  [[nodiscard]] int tracks(int node) const { return track_[at(node)]; }
  [[nodiscard]] int holes(int place) const { return hole_[at(place)]; }

 private:
  template <typename Use>
  void around(int place, int square, Use use) const {
    const int x = place % grid_.width(), y = place / grid_.width();
    const int reach = static_cast<int>(std::sqrt(square));
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int px = x + dx, py = y + dy;
        if (dx * dx + dy * dy > square || px < 0 || py < 0 || px >= grid_.width() || py >= grid_.height()) continue;
        use(py * grid_.width() + px);
      }
    }
  }
  void mark(int layer, int place, int by) {
    const std::size_t node = at(layer * grid_.nodes_per_layer() + place);
    if (stamp_[node] == now_) return;
    stamp_[node] = now_;
    track_[node] = static_cast<std::int16_t>(track_[node] + by);
  }
  void mark_hole(int place, int by) {
    std::uint32_t& stamp = stamp_[track_.size() + at(place)];
    if (stamp == now_) return;
    stamp = now_;
    hole_[at(place)] = static_cast<std::int16_t>(hole_[at(place)] + by);
  }

  const RouteGrid& grid_;
  std::vector<std::int16_t> track_, hole_;
  std::vector<std::uint32_t> stamp_;  // Each net counts once for a node, however much of its copper is near.
  std::uint32_t now_ = 0;
};

class Router {
 public:
  Router(const RouteGrid& grid, const std::vector<NetPads>& nets)
      : grid_(grid),
        nets_(nets),
        congestion_(grid),
        paths_(nets.size()),
        history_(at(kCopperLayers * grid.nodes_per_layer()), 0.0F),
        hole_history_(at(grid.nodes_per_layer()), 0.0F),
        cost_(history_.size()),
        from_(history_.size()),
        seen_(history_.size(), 0),
        done_(history_.size(), 0),
        target_(history_.size(), 0) {}

  std::vector<NetPath> run() {
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < nets_.size(); ++k) {
        if (round % kAllEvery > 0 && !is_crossed(k)) continue;
        congestion_.change(paths_[k], -1);
        paths_[k] = paths_of(nets_[k]);
        congestion_.change(paths_[k], 1);
      }
      if (!raise_prices()) return all();
      pressure_ *= kPressureGrowth;
    }
    throw std::logic_error("the tracks inside a module were not found: its pads leave too little room");
  }

 private:
  struct Step {
    float estimate;
    int node;
    bool operator<(const Step& other) const { return estimate > other.estimate; }
  };

  [[nodiscard]] int place_of(int node) const { return node % grid_.nodes_per_layer(); }

  template <typename Use>
  void for_uses(std::size_t net, Use use) const {
    for (const NetPath& path : paths_[net]) for_nodes(grid_, path, use);
  }
  [[nodiscard]] bool has_rival(int node) const { return congestion_.tracks(node) > 1; }
  [[nodiscard]] bool hole_has_rival(int node, bool is_hole) const {
    return is_hole && congestion_.holes(place_of(node)) > 1;
  }
  [[nodiscard]] bool is_crossed(std::size_t net) const {
    bool crossed = false;
    for_uses(net, [&](int node, bool is_hole) { crossed |= has_rival(node) || hole_has_rival(node, is_hole); });
    return crossed;
  }
  bool raise_prices() {
    bool any = false;
    for (std::size_t k = 0; k < nets_.size(); ++k) {
      for_uses(k, [&](int node, bool is_hole) {
        if (has_rival(node)) history_[at(node)] += kHistory;
        if (hole_has_rival(node, is_hole)) hole_history_[at(place_of(node))] += kHistory * kHoleCost;
        any |= has_rival(node) || hole_has_rival(node, is_hole);
      });
    }
    return any;
  }
  [[nodiscard]] std::vector<NetPath> all() const {
    std::vector<NetPath> result;
    for (const auto& paths : paths_) result.insert(result.end(), paths.begin(), paths.end());
    return result;
  }

  // The net's own copper was taken out of the congestion before.
  [[nodiscard]] std::vector<NetPath> paths_of(const NetPads& net) {
    std::vector<int> tree = net.start;
    holes_ = {};
    std::vector<NetPath> paths;
    std::size_t first = 0;
    if (tree.empty()) tree = net.pads[first++];
    for (std::size_t pad = first; pad < net.pads.size(); ++pad) {
      NetPath path{net.net, static_cast<int>(pad), search(tree, net.pads[pad], net.net)};
      for_nodes(grid_, path, [&](int node, bool is_hole) {
        if (is_hole) holes_.push_back(place_of(node));
      });
      tree.insert(tree.end(), path.nodes.begin(), path.nodes.end());
      paths.push_back(std::move(path));
    }
    return paths;
  }

  // Holes of one net stay apart too, unless they are the same.
  [[nodiscard]] bool is_beside_own_hole(int place) const {
    return std::ranges::any_of(holes_, [&](int hole) {
      const int dx = hole % grid_.width() - place % grid_.width(), dy = hole / grid_.width() - place / grid_.width();
      return hole != place && dx * dx + dy * dy <= kHoleHole;
    });
  }

  [[nodiscard]] float node_cost(int node) const {
    return (1.0F + history_[at(node)]) * (1.0F + pressure_ * static_cast<float>(congestion_.tracks(node)));
  }
  [[nodiscard]] float hole_cost(int place) const {
    return (kHoleCost + hole_history_[at(place)]) * (1.0F + pressure_ * static_cast<float>(congestion_.holes(place)));
  }

  // A* from the tree to the pad; returns the path from tree to pad.
  std::vector<int> search(const std::vector<int>& tree, const std::vector<int>& pad, int net) {
    begin(pad);
    std::priority_queue<Step> queue;
    for (const int node : tree) reach(queue, node, -1, 0.0F);
    while (!queue.empty()) {
      const auto [estimate, node] = queue.top();
      queue.pop();
      if (done_[at(node)] == now_) continue;
      done_[at(node)] = now_;
      if (target_[at(node)] == now_) return path_to(node);
      expand(queue, node, net);
    }
    throw std::logic_error("a pad of the module has no way to its net");
  }

  void begin(const std::vector<int>& pad) {
    ++now_;
    low_x_ = low_y_ = std::numeric_limits<int>::max();
    high_x_ = high_y_ = 0;
    for (const int node : pad) {
      target_[at(node)] = now_;
      const int x = place_of(node) % grid_.width(), y = place_of(node) / grid_.width();
      low_x_ = std::min(low_x_, x);
      high_x_ = std::max(high_x_, x);
      low_y_ = std::min(low_y_, y);
      high_y_ = std::max(high_y_, y);
    }
  }
  [[nodiscard]] float left(int node) const {
    const int x = place_of(node) % grid_.width(), y = place_of(node) / grid_.width();
    const int dx = std::max({0, low_x_ - x, x - high_x_}), dy = std::max({0, low_y_ - y, y - high_y_});
    return static_cast<float>(std::max(dx, dy)) + (kDiagonal - 1.0F) * static_cast<float>(std::min(dx, dy));
  }
  void reach(std::priority_queue<Step>& queue, int node, int from, float cost) {
    if (seen_[at(node)] == now_ && cost_[at(node)] <= cost) return;
    seen_[at(node)] = now_;
    cost_[at(node)] = cost;
    from_[at(node)] = from;
    queue.push({cost + left(node), node});
  }
  void expand(std::priority_queue<Step>& queue, int node, int net) {
    const int place = place_of(node), layer = node / grid_.nodes_per_layer();
    const int x = place % grid_.width(), y = place / grid_.width();
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int nx = x + dx, ny = y + dy;
        if ((dx == 0 && dy == 0) || nx < 0 || ny < 0 || nx >= grid_.width() || ny >= grid_.height()) continue;
        const int next = grid_.index({layer, nx, ny});
        if (!grid_.may_track(next, net)) continue;
        // The middle of a diagonal step may be nearer to a corner of other copper than both its ends.
        if (dx != 0 && dy != 0 &&
            !(grid_.may_track(grid_.index({layer, nx, y}), net) && grid_.may_track(grid_.index({layer, x, ny}), net)))
          continue;
        const float length = dx != 0 && dy != 0 ? kDiagonal : 1.0F;
        const float turn = is_straight(node, next) ? 0.0F : kTurnCost;
        reach(queue, next, node, cost_[at(node)] + length * node_cost(next) + turn);
      }
    }
    if (!grid_.may_drill(place, net) || is_beside_own_hole(place)) return;
    for (int l = 0; l < kCopperLayers; ++l) {
      const int next = grid_.index({l, x, y});
      if (l != layer && grid_.may_track(next, net)) reach(queue, next, node, cost_[at(node)] + hole_cost(place));
    }
  }
  [[nodiscard]] bool is_straight(int node, int next) const {
    const int before = from_[at(node)];
    return before < 0 || next - node == node - before || place_of(before) == place_of(node);
  }
  [[nodiscard]] std::vector<int> path_to(int node) const {
    std::vector<int> path;
    for (int n = node; n >= 0; n = from_[at(n)]) path.push_back(n);
    std::ranges::reverse(path);
    return path;
  }

  const RouteGrid& grid_;
  const std::vector<NetPads>& nets_;
  Congestion congestion_;
  std::vector<std::vector<NetPath>> paths_;  // For each net, those that it has now.
  std::vector<float> history_, hole_history_;
  float pressure_ = kFirstPressure;
  std::vector<float> cost_;
  std::vector<int> from_;
  std::vector<std::uint32_t> seen_, done_, target_;
  std::uint32_t now_ = 0;
  std::vector<int> holes_;
  int low_x_ = 0, high_x_ = 0, low_y_ = 0, high_y_ = 0;
};

}  // namespace

std::vector<NetPath> route_nets(const RouteGrid& grid, const std::vector<NetPads>& nets) {
  return Router(grid, nets).run();
}

}  // namespace triskin::fabrication
