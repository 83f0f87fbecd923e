// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference_cycles.hpp"

#include <algorithm>

namespace triskin::cad {

void ReferenceGraph::add(std::int64_t id, const std::vector<std::int64_t>& references, std::int64_t label) {
  nodes_.push_back({id, label, references_.size(), references.size()});
  references_.insert(references_.end(), references.begin(), references.end());
  is_sorted_ = false;
}

void ReferenceGraph::sort() {
  if (!is_sorted_) std::ranges::stable_sort(nodes_, {}, &Node::id);
  is_sorted_ = true;
}

std::size_t ReferenceGraph::first_of(std::int64_t id) const {
  return static_cast<std::size_t>(std::ranges::lower_bound(nodes_, id, {}, &Node::id) - nodes_.begin());
}

std::optional<std::int64_t> ReferenceGraph::defined_twice() {
  sort();
  const auto twice = std::ranges::adjacent_find(nodes_, {}, &Node::id);
  return twice == nodes_.end() ? std::nullopt : std::optional(twice->id);
}

std::vector<std::pair<std::int64_t, std::int64_t>> ReferenceGraph::dangling() {
  sort();
  std::vector<std::pair<std::int64_t, std::int64_t>> out;
  for (const Node& node : nodes_) {
    for (std::size_t k = 0; k < node.count; ++k) {
      const std::int64_t to = references_[node.first + k];
      const std::size_t at = first_of(to);
      if (at == nodes_.size() || nodes_[at].id != to) out.emplace_back(node.id, to);
    }
  }
  return out;
}

// Searches depth first with an explicit stack, because files have chains of 100,000 references. Several nodes may have
// the same id (a product with several components); a path continues through all of them.
std::vector<ReferenceGraph::Step> ReferenceGraph::circle() {
  sort();
  enum class State : std::uint8_t { kNew, kOnPath, kDone };
  struct Visit {
    std::size_t first, node, reference;
  };
  std::vector<State> states(nodes_.size(), State::kNew);  // The index is the first node of an id.
  std::vector<Visit> path;
  for (std::size_t root = 0; root < nodes_.size(); ++root) {
    const std::size_t start = first_of(nodes_[root].id);
    if (states[start] != State::kNew) continue;
    states[start] = State::kOnPath;
    path.push_back({start, start, 0});
    while (!path.empty()) {
      Visit& here = path.back();
      if (here.node == nodes_.size() || nodes_[here.node].id != nodes_[here.first].id) {
        states[here.first] = State::kDone;
        path.pop_back();
        continue;
      }
      if (here.reference == nodes_[here.node].count) {
        ++here.node;
        here.reference = 0;
        continue;
      }
      const std::int64_t to = references_[nodes_[here.node].first + here.reference++];
      const std::size_t next = first_of(to);
      if (next == nodes_.size() || nodes_[next].id != to || states[next] == State::kDone) continue;
      if (states[next] == State::kOnPath) {
        std::vector<Step> circle;
        const auto from = std::ranges::find(path, next, &Visit::first);
        for (auto step = from; step != path.end(); ++step)
          circle.push_back({nodes_[step->node].id, nodes_[step->node].label});
        return circle;
      }
      states[next] = State::kOnPath;
      path.push_back({next, next, 0});
    }
  }
  return {};
}

}  // namespace triskin::cad
