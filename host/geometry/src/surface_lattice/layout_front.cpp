// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout_front.hpp"

#include <algorithm>

namespace triskin::geometry::surface_lattice {

bool LayoutFront::would_keep(const LatticeNet& net, double value) const {
  const auto same = found_.find({net.size(), net.islands()});
  if (same != found_.end()) return value > same->second.value;
  return modules_ + net.size() <= most_modules_ || found_.empty() || value > least_valuable()->second.value;
}

void LayoutFront::keep(const NetCopy& net, double value) {
  if (!would_keep(*net, value)) return;
  const auto [place, is_new] = found_.insert_or_assign({net->size(), net->islands()}, FoundLayout{net, value});
  if (is_new) modules_ += net->size();
  while (modules_ > most_modules_ && found_.size() > 1) {
    const auto least = least_valuable();
    modules_ -= least->first.first;
    found_.erase(least);
  }
}

void LayoutFront::forget_below(int modules) {
  const auto end = found_.lower_bound({modules, 0});
  for (auto k = found_.begin(); k != end; ++k) modules_ -= k->first.first;
  found_.erase(found_.begin(), end);
}

std::map<LayoutFront::Numbers, FoundLayout>::const_iterator LayoutFront::least_valuable() const {
  return std::ranges::min_element(found_, {}, [](const auto& entry) { return entry.second.value; });
}

}  // namespace triskin::geometry::surface_lattice
