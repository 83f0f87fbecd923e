// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/bvh.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "triskin/base/index.hpp"
#include "triskin/base/parallel.hpp"

namespace triskin::mesh {
namespace {

constexpr int kLeafSize = 4;
constexpr std::size_t kWorthThreads = 20'000;  // With fewer items the threads cost more than they take over.
constexpr std::size_t kChunks = 256;           // Threads take the chunks of a level one by one.

}  // namespace

Bvh::Bvh(const std::vector<Extent>& extents, int threads) {
  if (extents.empty()) return;
  items_.resize(extents.size());
  std::iota(items_.begin(), items_.end(), 0);
  if (extents.size() < kWorthThreads) threads = 1;
  boxes_.reserve(extents.size());
  boxes_.push_back({.first = 0, .end = static_cast<int>(extents.size())});
  // The tree is filled level by level.
  for (std::size_t begin = 0, end = 1; begin < end; begin = std::exchange(end, boxes_.size())) {
    const std::size_t chunk = 1 + (end - begin) / kChunks;
    in_parallel(threads, (end - begin + chunk - 1) / chunk, [&](std::size_t k) {
      const std::size_t last = std::min(end, begin + (k + 1) * chunk);
      for (std::size_t n = begin + k * chunk; n < last; ++n) bound_and_part(boxes_[n], extents);
    });
    for (std::size_t n = begin; n < end; ++n) {
      const int first = boxes_[n].first, last = boxes_[n].end, count = last - first;
      if (count <= kLeafSize) continue;
      boxes_[n].left = static_cast<int>(boxes_.size());
      boxes_.push_back({.first = first, .end = first + count / 2});
      boxes_.push_back({.first = first + count / 2, .end = last});
    }
  }
  for (std::size_t n = 0; n < boxes_.size(); ++n) {
    if (boxes_[n].left < 0) leaves_.push_back(static_cast<int>(n));
  }
  std::ranges::sort(leaves_, {}, [&](int n) { return boxes_[at(n)].first; });
}

// The items of the lower half along the longest side come first.
void Bvh::bound_and_part(Box& box, const std::vector<Extent>& extents) {
  Eigen::Array3d low = extents[at(items_[at(box.first)])][0], high = extents[at(items_[at(box.first)])][1];
  for (int k = box.first; k < box.end; ++k) {
    low = low.min(extents[at(items_[at(k)])][0]);
    high = high.max(extents[at(items_[at(k)])][1]);
  }
  box.low = low;
  box.high = high;
  const int count = box.end - box.first;
  if (count <= kLeafSize) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle_of = [&](int item) { return extents[at(item)][0][axis] + extents[at(item)][1][axis]; };
  const auto begin = items_.begin() + box.first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](int a, int b) { return std::pair(middle_of(a), a) < std::pair(middle_of(b), b); });
}

}  // namespace triskin::mesh
