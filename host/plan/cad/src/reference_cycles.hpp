// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace triskin::cad {

/// Records which numbered entities refer to which others.
class ReferenceGraph {
 public:
  struct Step {
    std::int64_t id = 0;
    std::int64_t label = 0;  ///< add() got this label for the reference that leaves the entity.
  };

  /// Notes that `id` refers to these; circle() returns `label` for it.
  void add(std::int64_t id, const std::vector<std::int64_t>& references, std::int64_t label);

  /// Returns one cycle of references; empty if there is none. Cost: O(n log n), without recursion.
  [[nodiscard]] std::vector<Step> circle();
  /// Returns an id that was added more than once. Cost: O(n log n).
  [[nodiscard]] std::optional<std::int64_t> defined_twice();
  /// Returns references (from, to) to ids that were never added. Cost: O(n log n).
  [[nodiscard]] std::vector<std::pair<std::int64_t, std::int64_t>> dangling();

 private:
  struct Node {
    std::int64_t id, label;
    std::size_t first, count;  // The references are references_[first, first + count).
  };
  void sort();
  [[nodiscard]] std::size_t first_of(std::int64_t id) const;

  std::vector<Node> nodes_;
  std::vector<std::int64_t> references_;
  bool is_sorted_ = false;
};

}  // namespace triskin::cad
