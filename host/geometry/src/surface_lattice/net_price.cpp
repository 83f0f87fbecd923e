// SPDX-License-Identifier: GPL-3.0-or-later
#include "net_price.hpp"

#include <algorithm>

#include "jumper_sides.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kModulesAController = 16.0;
constexpr double kRoundedUp = 15.0 / 32.0;  // mean of ⌈n / 16⌉ − n / 16
constexpr double kStraight = 0.95;          // a jumper along the surface is a little longer than the straight line

}  // namespace

double relaxed_price(const std::vector<int>& sizes, const std::vector<int>& group, const Price& price) {
  std::vector<int> modules(sizes.size(), 0);
  int groups = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    groups += modules[at(group[k])] == 0 ? 1 : 0;
    modules[at(group[k])] += sizes[k];
  }
  double controllers = 0.0;
  for (const int n : modules) controllers += n > 0 ? std::max(1.0, n / kModulesAController + kRoundedUp) : 0.0;
  const double islands = static_cast<double>(sizes.size());
  return price.controller * controllers + price.jumper * (islands - groups) + price.island * islands;
}

int NetPrice::find(int island) {
  while (leader_[at(island)] != island) island = leader_[at(island)] = leader_[at(leader_[at(island)])];
  return island;
}

void NetPrice::group_islands(const LatticeNet& net) {
  sides_.clear();
  for (int t = 0; t < static_cast<int>(net.triangles.size()); ++t) {
    if (!net.used(t)) continue;
    const NetTriangle& triangle = net.triangles[at(t)];
    for (int s = 0; s < 3; ++s) {
      if (net.neighbour(t, s) >= 0) continue;
      const double x = 0.5 * (triangle.rigid[at(s)].x() + triangle.rigid[at((s + 1) % 3)].x());
      sides_.push_back({x, number_[at(triangle.island)], t, s});
    }
  }
  std::ranges::sort(sides_, {}, [](const Side& s) { return std::tuple(s.x, s.triangle, s.side); });
  const double reach = kStraight * jumper_mm_;
  for (std::size_t a = 0; a < sides_.size(); ++a) {
    for (std::size_t b = a + 1; b < sides_.size() && sides_[b].x - sides_[a].x <= reach; ++b) {
      if (sides_[a].island == sides_[b].island || find(sides_[a].island) == find(sides_[b].island)) continue;
      const FreeSide p = free_side(net.triangles[at(sides_[a].triangle)].rigid, at(sides_[a].side));
      const FreeSide q = free_side(net.triangles[at(sides_[b].triangle)].rigid, at(sides_[b].side));
      if ((p.middle - q.middle).squaredNorm() > reach * reach || !face_each_other(p, q)) continue;
      leader_[at(find(sides_[a].island))] = find(sides_[b].island);
    }
  }
}

double NetPrice::operator()(const LatticeNet& net) {
  number_.clear();
  sizes_.clear();
  for (const NetTriangle& t : net.triangles) {
    if (t.island < 0) continue;
    if (number_.size() <= at(t.island)) number_.resize(at(t.island) + 1, -1);
    int& number = number_[at(t.island)];
    if (number < 0) {
      number = static_cast<int>(sizes_.size());
      sizes_.push_back(0);
    }
    ++sizes_[at(number)];
  }
  leader_.resize(sizes_.size());
  for (std::size_t k = 0; k < leader_.size(); ++k) leader_[k] = static_cast<int>(k);
  if (sizes_.size() > 1 && jumper_mm_ > 0.0 && price_.jumper < price_.controller) group_islands(net);
  group_.resize(sizes_.size());
  for (std::size_t k = 0; k < group_.size(); ++k) group_[k] = find(static_cast<int>(k));
  return relaxed_price(sizes_, group_, price_);
}

}  // namespace triskin::geometry::surface_lattice
