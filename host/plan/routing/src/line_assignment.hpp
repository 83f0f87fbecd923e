// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

struct LineAssignment {
  Numbers line;       ///< Each node has its line, and at most `per_line` nodes share one.
  int line_hops = 0;  ///< The sum over the edges counts how many lines are used below each.
};

/// Finds the fewest line hops of a rooted tree, exactly: dynamic programme bottom-up over the sorted numbers of nodes
/// that a subtree puts on each line. A tree is given as parent[0] = −1 and parents before children; n ≤ lines ·
/// per_line. Keeps tables between calls, so each thread needs its own object. Cost: at most 8² pairs of fills per edge
/// for four lines of four.
class LineAssigner {
 public:
  LineAssigner(int lines, int per_line) : lines_(lines), per_line_(per_line) {}
  [[nodiscard]] int min_hops(const Numbers& parent);
  [[nodiscard]] LineAssignment assign(const Numbers& parent);
  /// Returns Σ over edges of ⌈size below / per_line⌉ ≤ min_hops.
  [[nodiscard]] int bound(const Numbers& parent) const;

 private:
  using Fill = Numbers;  // A fill counts the nodes on each line, the largest first.
  struct Way {           // Adds two fills so that line l of the second lies on line onto[l] of the first.
    int sum = 0;
    Numbers onto;
  };
  struct Entry {
    int fill = 0, cost = 0, before = 0, child = 0;
    const Way* way = nullptr;
  };
  using Entries = std::vector<Entry>;

  int number(const Fill& fill);
  const std::vector<Way>& ways(int a, int b);
  void solve(const Numbers& parent);
  void read_back(std::size_t v, int fill, Numbers physical, Numbers& line) const;

  int lines_, per_line_;
  Table<int, Fill> fills_;
  Numbers used_;
  std::map<Fill, int> numbers_;
  std::map<std::pair<int, int>, std::vector<Way>> ways_;
  Table<int, Numbers> children_;
  Table<int, std::vector<Entries>> tables_;
};

}  // namespace triskin::routing
