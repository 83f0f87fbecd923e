// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace triskin::cad {

/// Who refers to whom among numbered entities.
class ReferenceGraph {
 public:
  struct Step {
    std::int64_t id = 0;
    std::int64_t label = 0;  ///< It is the label given to add() for the reference that leaves it.
  };

  /// Notes that `id` refers to these; `label` stands for it in circle().
  void add(std::int64_t id, const std::vector<std::int64_t>& references, std::int64_t label);

  /// One circle of references; empty: there is none. Cost: O(n log n), without recursion.
  [[nodiscard]] std::vector<Step> circle();
  /// An id that add() got more than once. Cost: O(n log n).
  [[nodiscard]] std::optional<std::int64_t> defined_twice();
  /// References to ids that add() did not get: from, to. Cost: O(n log n).
  [[nodiscard]] std::vector<std::pair<std::int64_t, std::int64_t>> dangling();

 private:
  struct Node {
    std::int64_t id, label;
    std::size_t first, count;  // Range in references_.
  };
  void sort();
  [[nodiscard]] std::size_t first_of(std::int64_t id) const;

  std::vector<Node> nodes_;
  std::vector<std::int64_t> references_;
  bool is_sorted_ = false;
};

}  // namespace triskin::cad
