// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "triskin/base/index.hpp"

namespace triskin::lattice {

/// Keeps numbers that may be used again, the least first. A number may be taken elsewhere meanwhile, so pop() asks.
/// Value type.
class FreeNumbers {
 public:
  void push(int number) {
    if (holds_.size() <= at(number)) holds_.resize(at(number) + 1, 0);
    if (holds_[at(number)]) return;
    holds_[at(number)] = 1;
    heap_.push_back(number);
    std::ranges::push_heap(heap_, std::greater{});
  }
  /// Returns the smallest number for which `is_free(number)` is true, or −1; smaller ones are dropped.
  [[nodiscard]] int pop(const auto& is_free) {
    while (!heap_.empty()) {
      std::ranges::pop_heap(heap_, std::greater{});
      const int number = heap_.back();
      heap_.pop_back();
      holds_[at(number)] = 0;
      if (is_free(number)) return number;
    }
    return -1;
  }

 private:
  std::vector<int> heap_;
  std::vector<char> holds_;  // True while the number is in the heap.
};

}  // namespace triskin::lattice
