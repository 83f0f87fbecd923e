// SPDX-License-Identifier: GPL-3.0-or-later
#include "net_price.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "triskin/routing/jumper_sides.hpp"

namespace triskin::lattice {
namespace {

constexpr double kRoundedUp = 15.0 / 32.0;  // The mean of ⌈n / 16⌉ − n / 16.
// The centres of two modules are at most this much farther apart than the middles of their sides.
constexpr double kCenters_mm = 2.0 * kHeight_mm / 3.0 + 1.0;
constexpr double kStraight = 0.95;  // A jumper along the surface is a little longer than the straight line.

// Returns the controllers of n connected modules.
double relaxed_controllers(int n) {
  return n > 0 ? std::max(1.0, n / double{kModulesAController} + kRoundedUp) : 0.0;
}
double rounded_controllers(int n) {
  return std::ceil(n / double{kModulesAController});
}

RelaxedPrice price_of(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price,
                      double (*controllers_of)(int)) {
  std::vector<int> modules(group.empty() ? 0 : at(std::ranges::max(group)) + 1, 0);
  double pieces = 0.0, controllers = 0.0;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    pieces += controllers_of(sizes[k]);
    modules[at(group[k])] += sizes[k];
  }
  for (const int n : modules) controllers += controllers_of(n);
  const double islands = static_cast<double>(sizes.size());
  return {price.controller * controllers, price.jumper * (pieces - controllers) + price.island * islands};
}

}  // namespace

RelaxedPrice relaxed_price(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price) {
  return price_of(sizes, group, price, relaxed_controllers);
}

double rounded_price(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price) {
  return price_of(sizes, group, price, rounded_controllers).sum();
}

void NetPrice::unlink(int triangle) {
  if (at(triangle) >= linked_.size()) return;
  for (const int other : linked_[at(triangle)]) std::erase(linked_[at(other)], triangle);
  linked_[at(triangle)].clear();
}

// Returns true if both have free sides that face each other within the reach.
bool NetPrice::can_be_joined(const LatticeMesh& net, int a, int b) const {
  const double reach = kStraight * jumper_mm_;
  for (int s = 0; s < 3; ++s) {
    if (net.neighbour(a, s) >= 0) continue;
    const routing::FreeSide p = routing::free_side(net.triangles()[at(a)].rigid, at(s));
    for (int r = 0; r < 3; ++r) {
      if (net.neighbour(b, r) >= 0) continue;
      const routing::FreeSide q = routing::free_side(net.triangles()[at(b)].rigid, at(r));
      if ((p.middle - q.middle).squaredNorm() <= reach * reach && routing::face_each_other(p, q)) return true;
    }
  }
  return false;
}

void NetPrice::link(const LatticeMesh& net, int triangle) {
  if (net.neighbour(triangle, 0) >= 0 && net.neighbour(triangle, 1) >= 0 && net.neighbour(triangle, 2) >= 0) return;
  (void)net.any_near(net.center(triangle), kStraight * jumper_mm_ + kCenters_mm, [&](int other) {
    if (other == triangle || std::ranges::find(linked_[at(triangle)], other) != linked_[at(triangle)].end())
      return false;
    if (!can_be_joined(net, triangle, other)) return false;
    linked_[at(triangle)].push_back(other);
    linked_[at(other)].push_back(triangle);
    return false;
  });
}

void NetPrice::follow(LatticeMesh& net) {
  net.take_changed(changed_);
  if (!knows_net_) {
    linked_.clear();
    changed_.resize(net.triangles().size());
    std::iota(changed_.begin(), changed_.end(), 0);
    knows_net_ = true;
  }
  if (linked_.size() < net.triangles().size()) linked_.resize(net.triangles().size());
  for (const int t : changed_) unlink(t);
  for (const int t : changed_) {
    if (at(t) < net.triangles().size() && net.used(t)) link(net, t);
  }
}

EstimatedPrice NetPrice::operator()(LatticeMesh& net) {
  const std::vector<int>& by_id = net.island_sizes();
  islands_.reset(by_id.size());
  if (jumper_mm_ > 0.0 && price_.jumper < price_.controller) {
    follow(net);
    for (std::size_t t = 0; t < net.triangles().size(); ++t) {
      for (const int other : linked_[t]) islands_.join(net.triangles()[t].island, net.triangles()[at(other)].island);
    }
  }
  sizes_.clear();
  group_.clear();
  for (int id = 0; id < static_cast<int>(by_id.size()); ++id) {
    if (by_id[at(id)] == 0) continue;
    sizes_.push_back(by_id[at(id)]);
    group_.push_back(islands_.find(id));
  }
  return {relaxed_price(sizes_, group_, price_), rounded_price(sizes_, group_, price_)};
}

}  // namespace triskin::lattice
