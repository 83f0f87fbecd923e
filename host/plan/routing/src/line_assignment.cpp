// SPDX-License-Identifier: GPL-3.0-or-later
#include "line_assignment.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace triskin::routing {
namespace {

const auto by_cost = [](const auto& e) { return e.cost; };

}  // namespace

int LineAssigner::number(const Fill& fill) {
  const auto [found, is_new] = numbers_.try_emplace(fill, static_cast<int>(fills_.size()));
  if (is_new) {
    fills_.push_back(fill);
    used_.push_back(static_cast<int>(std::ranges::count_if(fill, [](int n) { return n > 0; })));
  }
  return found->second;
}

// Lists distinct sums only, each with the first permutation that gives it.
const std::vector<LineAssigner::Way>& LineAssigner::ways(int a, int b) {
  const auto [found, is_new] = ways_.try_emplace({a, b});
  if (!is_new) return found->second;
  const Fill first = fills_[a], second = fills_[b];
  Numbers onto(static_cast<std::size_t>(lines_));
  std::iota(onto.begin(), onto.end(), 0);
  do {
    Fill sum = first;
    for (std::size_t l = 0; l < sum.size(); ++l) sum[onto[l]] += second[l];
    if (*std::ranges::max_element(sum) > per_line_) continue;
    std::ranges::sort(sum, std::greater<>());
    const int s = number(sum);
    if (std::ranges::count(found->second, s, &Way::sum) == 0) found->second.push_back({s, onto});
  } while (std::ranges::next_permutation(onto).found);
  return found->second;
}

// tables_[v][k] has the fills of v with its first k children; each step keeps the cheapest way to a fill.
void LineAssigner::solve(const Numbers& parent) {
  children_.assign(parent.size(), {});
  tables_.assign(parent.size(), {});
  for (std::size_t v = 1; v < parent.size(); ++v) children_[parent[v]].push_back(static_cast<int>(v));
  Fill one(static_cast<std::size_t>(lines_), 0);
  one[0] = 1;
  const int alone = number(one);
  for (std::size_t v = parent.size(); v-- > 0;) {
    tables_[v].push_back({{alone, 0, 0, 0, nullptr}});
    for (const int c : children_[v]) {
      Entries next;
      for (const Entry& mine : tables_[v].back()) {
        for (const Entry& below : tables_[c].back()) {
          const int cost = mine.cost + below.cost + used_[below.fill];
          for (const Way& way : ways(mine.fill, below.fill)) {
            const auto old = std::ranges::find(next, way.sum, &Entry::fill);
            if (old == next.end())
              next.push_back({way.sum, cost, mine.fill, below.fill, &way});
            else if (cost < old->cost)
              *old = {way.sum, cost, mine.fill, below.fill, &way};
          }
        }
      }
      tables_[v].push_back(std::move(next));
    }
  }
  if (tables_[0].back().empty()) throw std::logic_error("line assignment: more nodes than the lines carry");
}

int LineAssigner::min_hops(const Numbers& parent) {
  solve(parent);
  return std::ranges::min_element(tables_[0].back(), {}, by_cost)->cost;
}

LineAssignment LineAssigner::assign(const Numbers& parent) {
  solve(parent);
  const Entry& best = *std::ranges::min_element(tables_[0].back(), {}, by_cost);
  LineAssignment result{Numbers(parent.size(), -1), best.cost};
  Numbers physical(static_cast<std::size_t>(lines_));
  std::iota(physical.begin(), physical.end(), 0);
  read_back(0, best.fill, physical, result.line);
  return result;
}

// `physical[position]` is the line at this position of the sorted fill.
void LineAssigner::read_back(std::size_t v, int fill, Numbers physical, Numbers& line) const {
  for (std::size_t k = children_[v].size(); k > 0; --k) {
    const Entry& e = *std::ranges::find(tables_[v][k], fill, &Entry::fill);
    // Sorting moved the lines, so we search which position of the sum each position of `before` became.
    Fill sum = fills_[e.before];
    const Fill& child = fills_[e.child];
    for (std::size_t l = 0; l < sum.size(); ++l) sum[e.way->onto[l]] += child[l];
    std::vector<std::size_t> order(sum.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return sum[a] > sum[b]; });
    Numbers before(sum.size()), below(sum.size());
    for (std::size_t p = 0; p < order.size(); ++p) before[order[p]] = physical[p];
    for (std::size_t l = 0; l < sum.size(); ++l) below[l] = before[e.way->onto[l]];
    read_back(static_cast<std::size_t>(children_[v][k - 1]), e.child, below, line);
    fill = e.before;
    physical = before;
  }
  line[v] = physical[0];
}

int LineAssigner::bound(const Numbers& parent) const {
  Numbers size(parent.size(), 1);
  int sum = 0;
  for (std::size_t v = parent.size(); v-- > 1;) {
    size[parent[v]] += size[v];
    sum += (size[v] + per_line_ - 1) / per_line_;
  }
  return sum;
}

}  // namespace triskin::routing
