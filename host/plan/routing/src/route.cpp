// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>

#include "failures.hpp"
#include "jumper_partition.hpp"
#include "partition.hpp"
#include "recombination.hpp"
#include "triskin/base/disjoint_sets.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/parallel.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/routing/routing.hpp"
#include "wiring.hpp"

namespace triskin::routing {
namespace {

constexpr int kMaxMoves = 5000;  // Bounds the time of recombination for very large islands.

void require_joints(const ModuleGraph& graph) {
  const int n = static_cast<int>(graph.nodes.size());
  for (int v = 0; v < n; ++v) {
    const auto& mine = graph.nodes[at(v)].neighbour;
    for (const int w : mine) {
      if (w < 0) continue;
      const bool back = w < n && w != v && std::ranges::count(graph.nodes[at(w)].neighbour, v) == 1;
      if (!back)
        throw InputError(
            fmt::format("module {}: joined to {}, which is not joined to it once; make the joints symmetric", v, w));
      if (std::ranges::count(mine, w) != 1)
        throw InputError(fmt::format("module {}: joined to {} twice; name the joint once", v, w));
    }
  }
}

void require_options(const RoutingOptions& o) {
  const bool sizes = o.capacity >= 1 && o.capacity <= kModulesAController && o.lines >= 1 && o.lines <= 4 &&
                     o.addresses >= 1 && o.addresses <= 16;
  if (o.threads < 1) throw InputError("routing: at least one thread is needed");
  if (!sizes) throw InputError("routing: capacity 1 … 16, lines 1 … 4, addresses 1 … 16 are possible");
  if (o.lines * o.addresses < o.capacity) {
    throw InputError(fmt::format("routing: {} lines of {} addresses carry fewer than {} modules; lower the capacity",
                                 o.lines, o.addresses, o.capacity));
  }
}

// Returns −1 for a node that the graph lacks.
int local_node(const LocalGraph& g, int node) {
  const auto found = std::ranges::lower_bound(g.node, node);
  return found != g.node.end() && *found == node ? static_cast<int>(found - g.node.begin()) : -1;
}

// Returns the shortest of the places that hold each part together, as few as possible, given what is connected without
// them.
std::vector<Jumper> fitted_jumpers(const JumperGraph& g, const std::vector<Jumper>& places, const Numbers& part_of) {
  DisjointSets sets(part_of.size());
  for (int v = 0; v < g.apart.size(); ++v) {
    for (const int w : g.apart.neighbour[v]) {
      if (w >= 0 && part_of[w] == part_of[v]) sets.join(v, w);
    }
  }
  std::vector<Jumper> fitted;
  for (const Jumper& j : places) {
    const int a = local_node(g.joined, j.node[0]), b = local_node(g.joined, j.node[1]);
    if (a < 0 || b < 0 || part_of[a] != part_of[b]) continue;
    if (sets.join(a, b)) fitted.push_back(j);
  }
  return fitted;
}

struct IslandDivision {
  Numbers part_of;
  int parts = 0, parts_bound = 0, jumpers_bound = 0;
  PartitionProof proof = PartitionProof::kOpen;
  bool price_proved = false;
};

}  // namespace

class Division {
 public:
  std::vector<IslandDivision> islands;
};

namespace {

class Router {
 public:
  Router(const ModuleGraph& graph, const std::vector<Jumper>& places, const RoutingOptions& options)
      : apart_(graph), graph_(graph), places_(places), options_(options), lines_(options.lines, options.addresses) {
    std::ranges::stable_sort(places_, {}, &Jumper::length_mm);
    possible_ = design::with_jumpers(apart_, places_);
  }

  void run(const ProgressSink& progress) {
    const auto islands = components(possible_);
    result_.division = options_.division != nullptr ? options_.division : divide(islands);
    require_division(islands);
    for (std::size_t k = 0; k < islands.size(); ++k) {
      report(progress, "routing", static_cast<double>(k) / static_cast<double>(islands.size()));
      const IslandDivision& division = result_.division->islands[k];
      places_.empty() ? route_island(islands[k], division) : route_with_jumpers(islands[k], division);
      result_.lower_bound += division.parts_bound;
      result_.jumpers_lower_bound += division.jumpers_bound;
      result_.proof = std::max(result_.proof, division.proof);
      price_proved_ = price_proved_ && division.price_proved;
    }
    std::ranges::sort(result_.jumpers, {}, &Jumper::node);
  }

  [[nodiscard]] std::shared_ptr<const Division> divide(const Table<int, Numbers>& islands) const {
    auto division = std::make_shared<Division>();
    division->islands.resize(islands.size());
    in_parallel(options_.threads, islands.size(), [&](std::size_t k) {
      division->islands[k] = places_.empty() ? divide_island(islands[k]) : divide_with_jumpers(islands[k]);
    });
    return division;
  }

  [[nodiscard]] IslandDivision divide_island(const Numbers& nodes) const {
    const Partition p = partition(localize(apart_, nodes), options_.capacity, options_.seed, options_.give_up);
    return {p.part_of, p.parts, p.lower_bound, 0, p.proof, p.parts == p.lower_bound};
  }

  [[nodiscard]] JumperGraph possible_jumpers(const Numbers& nodes) const {
    return jumper_graph(possible_, apart_, nodes);
  }
  [[nodiscard]] IslandDivision divide_with_jumpers(const Numbers& nodes) const {
    const JumperPartition p = partition_with_jumpers(possible_jumpers(nodes), options_.capacity, options_.price,
                                                     options_.seed, options_.give_up);
    const PartitionProof proof = p.parts == p.parts_bound ? PartitionProof::kSize : PartitionProof::kOpen;
    return {p.part_of, p.parts, p.parts_bound, p.jumpers_bound, proof, p.proved};
  }

  void route_island(const Numbers& nodes, const IslandDivision& division) {
    const LocalGraph g = localize(graph_, nodes);
    Partition p = as_partition(division);
    Dice random(options_.seed + 1);
    recombine(graph_, g, options_, std::min(kMaxMoves, options_.recombinations * p.parts), random, p);
    wire_parts(g, p);
  }

  void route_with_jumpers(const Numbers& nodes, const IslandDivision& division) {
    fit(fitted_jumpers(possible_jumpers(nodes), places_, division.part_of));
    const JumperGraph g = jumper_graph(graph_, apart_, nodes);
    Partition p = as_partition(division);
    Dice random(options_.seed + 1);
    recombine(graph_, g.joined, options_, std::min(kMaxMoves, options_.recombinations * p.parts), random, p,
              &g.over_jumper);
    const std::vector<Jumper> kept = fitted_jumpers(g, fitted_, p.part_of);
    fit(kept);
    wire_parts(localize(graph_, nodes), p);
    result_.jumpers.insert(result_.jumpers.end(), kept.begin(), kept.end());
  }

  RoutingResult finish() {
    if (options_.failure_analysis) analyse_failures(graph_, options_, result_.patches);
    double rerouted = 0.0, strapped = 0.0, backed_up = 0.0;
    int failures = 0;
    for (const Patch& patch : result_.patches) {
      result_.line_hops += patch.line_hops;
      result_.max_depth = std::max(result_.max_depth, patch.max_depth);
      result_.patches_without_border += patch.border_entry ? 0 : 1;
      result_.electrical_violations += patch.electrical_violations;
      for (const FailureLoss& f : patch.failures) {
        const int itself = f.other_node < 0 ? 1 : 0;
        rerouted += f.lost_one_entry - itself;
        strapped += f.lost_strapped - itself;
        backed_up += f.lost_backed_up - itself;
        ++failures;
      }
    }
    if (failures > 0) {
      result_.mean_loss = backed_up / failures;
      result_.mean_loss_one_entry = rerouted / failures;
      result_.mean_loss_strapped = strapped / failures;
    }
    result_.proved = static_cast<int>(result_.patches.size()) == result_.lower_bound;
    result_.price_proved = price_proved_;
    return std::move(result_);
  }

 private:
  static Partition as_partition(const IslandDivision& d) { return {d.part_of, d.parts, d.parts_bound, d.proof}; }

  void require_division(const Table<int, Numbers>& islands) const {
    const auto& divided = result_.division->islands;
    bool same = divided.size() == islands.size();
    for (std::size_t k = 0; same && k < islands.size(); ++k) same = divided[k].part_of.size() == islands[k].size();
    if (!same) throw InputError("routing: the division is that of another graph; leave it out");
  }

  void wire_parts(const LocalGraph& g, const Partition& p) {
    Table<int, Numbers> parts(at(p.parts));
    for (int v = 0; v < g.size(); ++v) parts[p.part_of[v]].push_back(g.node[v]);
    std::ranges::sort(parts);
    for (const auto& part : parts) result_.patches.push_back(wire(graph_, part, options_, lines_, fitted_));
  }

  // Fits these jumpers in addition to those of earlier islands.
  void fit(const std::vector<Jumper>& jumpers) {
    fitted_ = result_.jumpers;
    fitted_.insert(fitted_.end(), jumpers.begin(), jumpers.end());
    graph_ = design::with_jumpers(apart_, fitted_);
  }

  const ModuleGraph& apart_;    // This graph has no jumpers.
  ModuleGraph possible_;        // This graph has a jumper at each possible place.
  ModuleGraph graph_;           // This graph has the fitted jumpers.
  std::vector<Jumper> places_;  // The shortest comes first.
  std::vector<Jumper> fitted_;
  bool price_proved_ = true;
  const RoutingOptions& options_;
  LineAssigner lines_;
  RoutingResult result_;
};

}  // namespace

RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options, const ProgressSink& progress) {
  return route(graph, {}, options, progress);
}

RoutingResult route(const ModuleGraph& graph, const std::vector<Jumper>& places, const RoutingOptions& options,
                    const ProgressSink& progress) {
  require_joints(graph);
  require_options(options);
  const auto start = std::chrono::steady_clock::now();
  Router router(graph, places, options);
  router.run(progress);
  RoutingResult result = router.finish();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace triskin::routing
