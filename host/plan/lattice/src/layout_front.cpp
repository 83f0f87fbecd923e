// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout_front.hpp"

#include <algorithm>

#include "net_price.hpp"

namespace triskin::lattice {

bool LayoutFront::would_keep(const LatticeMesh& net, double value) const {
  const auto same = found_.find({net.size(), net.islands()});
  if (same != found_.end()) return value > same->second.value;
  return modules_ + net.size() <= max_modules_ || found_.empty() || value > min_valuable()->second.value;
}

void LayoutFront::keep(const NetCopy& net, double value) {
  if (!would_keep(*net, value)) return;
  const auto [place, is_new] = found_.insert_or_assign({net->size(), net->islands()}, FoundLayout{net, value});
  if (is_new) modules_ += net->size();
  while (modules_ > max_modules_ && found_.size() > 1) {
    const auto least = min_valuable();
    modules_ -= least->first.first;
    found_.erase(least);
  }
}

void LayoutFront::forget_below(int modules) {
  const auto end = found_.lower_bound({modules, 0});
  for (auto k = found_.begin(); k != end; ++k) modules_ -= k->first.first;
  found_.erase(found_.begin(), end);
}

std::map<LayoutFront::Numbers, FoundLayout>::const_iterator LayoutFront::min_valuable() const {
  return std::ranges::min_element(found_, {}, [](const auto& entry) { return entry.second.value; });
}

namespace {

// Lists the triangles of each removable island, the smallest island first.
std::vector<std::vector<int>> small_islands(const LatticeMesh& net) {
  std::vector<std::vector<int>> islands(net.island_sizes().size());
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    if (net.used(t)) islands[at(net.triangles()[at(t)].island)].push_back(t);
  }
  std::erase_if(islands, [&](const std::vector<int>& island) {
    return island.empty() || island.size() > kModulesAController ||
           std::ranges::any_of(island, [&](int t) { return net.triangles()[at(t)].is_fixed; });
  });
  std::ranges::stable_sort(islands, {}, &std::vector<int>::size);
  return islands;
}

}  // namespace

std::vector<LatticeMesh> thinned(const LatticeMesh& net, int modules, std::size_t layouts) {
  std::vector<std::vector<int>> islands = small_islands(net);
  std::size_t going = 0;
  for (int left = net.size(); left > modules && going < islands.size(); ++going)
    left -= static_cast<int>(islands[going].size());
  const std::size_t step = (going + layouts - 1) / layouts;
  std::vector<LatticeMesh> nets;
  for (std::size_t count = going; count > 0; count -= std::min(step, count)) {
    LatticeMesh less = net;
    for (std::size_t k = 0; k < count; ++k) {
      for (const int t : islands[k]) less.remove_triangle(t);
    }
    less.separate();
    if (less.size() > 0) nets.push_back(std::move(less));
  }
  return nets;
}

}  // namespace triskin::lattice
