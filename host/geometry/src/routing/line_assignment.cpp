// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_assignment.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

namespace triskin::geometry {
namespace {

using Fill = std::vector<int>;  // nodes on each line, largest first

// How a fill of a subtree came about, to read the assignment back.
struct Origin {
  int cost = 0;
  Fill before;           // fill of the node with its earlier children
  Fill child;            // fill of the child's subtree
  std::vector<int> onto; // line of the child's fill → line of `before`, as positions; result is sorted afterwards
};
using Table = std::map<Fill, Origin>;

class LineProgramme {
 public:
  LineProgramme(const std::vector<int>& parent, int lines, int per_line)
      : parent_(parent), lines_(lines), per_line_(per_line), children_(parent.size()), tables_(parent.size()) {
    for (std::size_t v = 1; v < parent.size(); ++v) children_[static_cast<std::size_t>(parent[v])].push_back(static_cast<int>(v));
  }

  LineAssignment run() {
    for (std::size_t v = parent_.size(); v-- > 0;) solve(v);
    LineAssignment result;
    result.line.assign(parent_.size(), -1);
    const Table& root = tables_[0].back();
    if (root.empty()) throw std::logic_error("line assignment: more nodes than lines carry");
    const auto best = std::ranges::min_element(root, {}, [](const auto& e) { return e.second.cost; });
    result.line_hops = best->second.cost;
    std::vector<int> physical(static_cast<std::size_t>(lines_));
    std::iota(physical.begin(), physical.end(), 0);
    read_back(0, best->first, physical, result.line);
    return result;
  }

 private:
  // tables_[v][k]: fills of v with its first k children; each step keeps the cheapest way to a fill.
  void solve(std::size_t v) {
    Fill alone(static_cast<std::size_t>(lines_), 0);
    alone[0] = 1;
    tables_[v].push_back({{alone, {}}});
    for (const int c : children_[v]) {
      Table next;
      for (const auto& [fill, origin] : tables_[v].back()) {
        for (const auto& [child_fill, child_origin] : tables_[static_cast<std::size_t>(c)].back()) {
          merge(fill, origin.cost, child_fill, child_origin.cost, next);
        }
      }
      tables_[v].push_back(std::move(next));
    }
  }

  void merge(const Fill& fill, int cost, const Fill& child, int child_cost, Table& next) const {
    const int used = static_cast<int>(std::ranges::count_if(child, [](int n) { return n > 0; }));
    std::vector<int> onto(static_cast<std::size_t>(lines_));
    std::iota(onto.begin(), onto.end(), 0);
    do {
      Fill sum = fill;
      bool fits = true;
      for (std::size_t l = 0; l < sum.size() && fits; ++l) {
        int& n = sum[static_cast<std::size_t>(onto[l])];
        n += child[l];
        fits = n <= per_line_;
      }
      if (!fits) continue;
      std::ranges::sort(sum, std::greater<>());
      const int total = cost + child_cost + used;
      const auto found = next.find(sum);
      if (found == next.end() || total < found->second.cost) next[sum] = {total, fill, child, onto};
    } while (std::ranges::next_permutation(onto).found);
  }

  // `physical[position]`: line that stands at this position of the sorted fill.
  void read_back(std::size_t v, Fill fill, std::vector<int> physical, std::vector<int>& line) {
    for (std::size_t k = children_[v].size(); k > 0; --k) {
      const Origin& o = tables_[v][k].at(fill);
      // Sorting moved the lines: find which position of the sum each position of `before` became.
      Fill sum = o.before;
      for (std::size_t l = 0; l < sum.size(); ++l) sum[static_cast<std::size_t>(o.onto[l])] += o.child[l];
      std::vector<std::size_t> order(sum.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return sum[a] > sum[b]; });
      std::vector<int> before(sum.size());
      for (std::size_t p = 0; p < order.size(); ++p) before[order[p]] = physical[p];
      std::vector<int> below(sum.size());
      for (std::size_t l = 0; l < sum.size(); ++l) below[l] = before[static_cast<std::size_t>(o.onto[l])];
      read_back(static_cast<std::size_t>(children_[v][k - 1]), o.child, below, line);
      fill = o.before;
      physical = before;
    }
    line[v] = physical[0];
  }

  const std::vector<int>& parent_;
  int lines_, per_line_;
  std::vector<std::vector<int>> children_;
  std::vector<std::vector<Table>> tables_;
};

}  // namespace

LineAssignment assign_lines(const std::vector<int>& parent, int lines, int per_line) {
  return LineProgramme(parent, lines, per_line).run();
}

}  // namespace triskin::geometry
