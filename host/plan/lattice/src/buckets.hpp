// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/index.hpp"

namespace triskin::lattice {

/// Keeps items 0, 1, 2 … in numbered buckets, each item in one bucket or in none: doubly linked lists in arrays, so
/// that adding, removing and copying cost no allocation per item. The order within a bucket has no meaning.
class Buckets {
 public:
  Buckets() = default;
  /// Makes empty buckets 0 … count − 1.
  explicit Buckets(int count) : first_(at(count), -1) {}

  [[nodiscard]] int count() const { return static_cast<int>(first_.size()); }
  /// Returns the first item of a bucket, or the one after an item; −1 at the end.
  [[nodiscard]] int first(int bucket) const { return first_[at(bucket)]; }
  [[nodiscard]] int next(int item) const { return next_[at(item)]; }
  /// Returns the bucket of an item, −1 if it is in none.
  [[nodiscard]] int bucket_of(int item) const { return at(item) < bucket_.size() ? bucket_[at(item)] : -1; }

  /// The item must not be in any bucket yet.
  void add(int item, int bucket) {
    if (bucket_.size() <= at(item)) {
      bucket_.resize(at(item) + 1, -1);
      next_.resize(at(item) + 1, -1);
      previous_.resize(at(item) + 1, -1);
    }
    const int second = first_[at(bucket)];
    bucket_[at(item)] = bucket;
    next_[at(item)] = second;
    previous_[at(item)] = -1;
    if (second >= 0) previous_[at(second)] = item;
    first_[at(bucket)] = item;
  }

  /// The item must be in a bucket.
  void remove(int item) {
    const int before = previous_[at(item)], after = next_[at(item)];
    if (before >= 0) next_[at(before)] = after;
    if (before < 0) first_[at(bucket_[at(item)])] = after;
    if (after >= 0) previous_[at(after)] = before;
    bucket_[at(item)] = -1;
  }

 private:
  std::vector<int> first_;
  std::vector<int> bucket_, next_, previous_;
};

}  // namespace triskin::lattice
