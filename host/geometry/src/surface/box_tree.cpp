// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "index.hpp"

namespace triskin::geometry {

BoxTree::BoxTree(const std::vector<Extent>& extents) {
  constexpr int kLeafSize = 4;
  items_.resize(extents.size());
  std::iota(items_.begin(), items_.end(), 0);
  if (extents.empty()) return;
  boxes_.push_back({.first = 0, .count = static_cast<int>(extents.size())});
  for (std::size_t n = 0; n < boxes_.size(); ++n) {  // boxes appended while walking: breadth first
    const int first = boxes_[n].first, count = boxes_[n].count;
    Eigen::Array3d low = extents[at(items_[at(first)])][0], high = extents[at(items_[at(first)])][1];
    for (int k = first; k < first + count; ++k) {
      low = low.min(extents[at(items_[at(k)])][0]);
      high = high.max(extents[at(items_[at(k)])][1]);
    }
    boxes_[n].low = low;
    boxes_[n].high = high;
    if (count <= kLeafSize) continue;
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto middle_of = [&](int item) { return extents[at(item)][0][axis] + extents[at(item)][1][axis]; };
    const auto begin = items_.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](int a, int b) { return std::pair(middle_of(a), a) < std::pair(middle_of(b), b); });
    boxes_[n].left = static_cast<int>(boxes_.size());
    boxes_[n].right = boxes_[n].left + 1;
    boxes_[n].count = 0;
    boxes_.push_back({.first = first, .count = count / 2});
    boxes_.push_back({.first = first + count / 2, .count = count - count / 2});
  }
}

}  // namespace triskin::geometry
