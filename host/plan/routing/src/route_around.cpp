// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <set>

#include "failures.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::routing {
namespace {

// The part of a graph that is not wired yet, with its own node numbers.
class OpenPart {
 public:
  OpenPart(const ModuleGraph& whole, const KeptWiring& kept) : local_(whole.nodes.size(), 0) {
    for (const Patch& patch : kept.patches) {
      for (const RoutedModule& m : patch.modules) local_.at(at(m.node)) = -1;
    }
    for (std::size_t v = 0; v < local_.size(); ++v) {
      if (local_[v] < 0) continue;
      local_[v] = static_cast<int>(node_.size());
      node_.push_back(static_cast<int>(v));
    }
    for (const int v : node_) graph_.nodes.push_back(cut_off(whole.nodes[at(v)]));
  }

  [[nodiscard]] const ModuleGraph& graph() const { return graph_; }
  [[nodiscard]] std::vector<Jumper> places(const std::vector<Jumper>& all) const {
    std::vector<Jumper> mine;
    for (Jumper jumper : all) {
      for (int& node : jumper.node) node = local_.at(at(node));
      if (jumper.node[0] >= 0 && jumper.node[1] >= 0) mine.push_back(jumper);
    }
    return mine;
  }
  [[nodiscard]] Jumper whole(Jumper jumper) const {
    for (int& node : jumper.node) node = whole(node);
    return jumper;
  }
  [[nodiscard]] Patch whole(Patch patch) const {
    patch.entry = whole(patch.entry);
    for (RoutedModule& m : patch.modules) {
      m.node = whole(m.node);
      m.parent = whole(m.parent);
    }
    for (auto& joint : patch.cut_joints) {
      for (int& node : joint) node = whole(node);
    }
    return patch;
  }

 private:
  [[nodiscard]] int whole(int node) const { return node < 0 ? node : node_[node]; }

  // No cable reaches a side that is joined to a kept module, so border stays false there.
  [[nodiscard]] ModuleGraph::Node cut_off(ModuleGraph::Node node) const {
    for (int& neighbour : node.neighbour) neighbour = neighbour < 0 ? -1 : local_[neighbour];
    return node;
  }

  Numbers local_;  // The index is a node of the whole graph; −1 marks kept ones.
  Numbers node_;
  ModuleGraph graph_;
};

// New patches take the free places, and the remaining ones follow at the end; a place before the last patch may stay
// free.
std::vector<Patch> merged(std::vector<Patch> kept, std::vector<Patch> added) {
  std::size_t next = 0;
  for (Patch& patch : kept) {
    if (patch.is_gap() && next < added.size()) patch = std::move(added[next++]);
  }
  while (next < added.size()) kept.push_back(std::move(added[next++]));
  while (!kept.empty() && kept.back().is_gap()) kept.pop_back();
  return kept;
}

}  // namespace

RoutingResult route_around(const ModuleGraph& graph, const std::vector<Jumper>& places, const KeptWiring& kept,
                           const RoutingOptions& options, const ProgressSink& progress) {
  RoutingOptions without_failures = options;
  without_failures.failure_analysis = false;
  without_failures.division = nullptr;
  RoutingResult result = route(graph, places, without_failures, progress);  // Only the bounds of this result are used.
  const std::size_t fewest = result.patches.size();
  const OpenPart open(graph, kept);
  std::vector<Patch> added;
  result.jumpers = kept.jumpers;
  if (!open.graph().nodes.empty()) {
    RoutingResult rest = route(open.graph(), open.places(places), without_failures, progress);
    for (Patch& patch : rest.patches) added.push_back(open.whole(std::move(patch)));
    for (const Jumper& jumper : rest.jumpers) result.jumpers.push_back(open.whole(jumper));
  }
  std::ranges::sort(result.jumpers, {}, &Jumper::node);
  result.patches = merged(kept.patches, std::move(added));
  const ModuleGraph joined = design::with_jumpers(graph, result.jumpers);
  for (Patch& patch : result.patches) {
    if (patch.is_gap()) continue;
    const auto& entry = patch.modules.front();
    patch.border_entry = joined.nodes.at(at(entry.node)).border.at(at(entry.rotation));
  }
  if (options.failure_analysis) {
    std::set<int> entries;
    for (const Patch& patch : kept.patches) entries.insert(patch.entry);  // −1 for gaps
    std::vector<bool> is_kept;
    for (const Patch& patch : result.patches) is_kept.push_back(entries.contains(patch.entry));
    analyse_failures(joined, options, result.patches, is_kept);
  }
  const auto controllers =
      result.patches.size() - static_cast<std::size_t>(std::ranges::count_if(result.patches, &Patch::is_gap));
  result.proved = static_cast<int>(controllers) == result.lower_bound;
  // The bound held for that number of controllers.
  if (controllers != fewest) result.jumpers_lower_bound = 0;
  result.price_proved = false;
  return result;
}

}  // namespace triskin::routing
