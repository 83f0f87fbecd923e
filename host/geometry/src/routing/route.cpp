// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>

#include "failures.hpp"
#include "milp.hpp"
#include "partition.hpp"
#include "recombination.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/host/error.hpp"
#include "wiring.hpp"

namespace triskin::geometry {
namespace {

constexpr int kMostMoves = 5000;          // of recombination, an island: bounds the time of very large ones
constexpr double kMilpWorthwhile_s = 10;  // CBC decides little in less

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
  const bool sizes =
      o.capacity >= 1 && o.capacity <= 16 && o.lines >= 1 && o.lines <= 4 && o.addresses >= 1 && o.addresses <= 16;
  if (!sizes) throw InputError("routing: capacity 1 … 16, lines 1 … 4, addresses 1 … 16 are possible");
  if (o.lines * o.addresses < o.capacity) {
    throw InputError(fmt::format("routing: {} lines of {} addresses carry fewer than {} modules; lower the capacity",
                                 o.lines, o.addresses, o.capacity));
  }
}

class Router {
 public:
  Router(const ModuleGraph& graph, const RoutingOptions& options)
      : graph_(graph), options_(options), lines_(options.lines, options.addresses) {}

  void route_island(const std::vector<int>& nodes) {
    const LocalGraph g = localize(graph_, nodes);
    const double milp_s = options_.milp && options_.time_limit_s >= kMilpWorthwhile_s ? options_.time_limit_s : 0.0;
    Partition p = partition(g, options_.capacity, options_.seed, milp_s);
    Dice random(options_.seed + 1);
    recombine(graph_, g, options_, std::min(kMostMoves, options_.recombinations * p.parts), random, p);
    std::vector<std::vector<int>> parts(at(p.parts));
    for (int v = 0; v < g.size(); ++v) parts[at(p.part_of[at(v)])].push_back(g.node[at(v)]);
    std::ranges::sort(parts);
    for (const auto& part : parts) result_.patches.push_back(wire(graph_, part, options_, lines_));
    result_.lower_bound += p.lower_bound;
    result_.proof = std::max(result_.proof, p.proof);
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
        rerouted += f.lost_rerouted - itself;
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
    return std::move(result_);
  }

 private:
  const ModuleGraph& graph_;
  const RoutingOptions& options_;
  LineAssigner lines_;
  RoutingResult result_;
};

}  // namespace

RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options, const ProgressSink& progress) {
  require_joints(graph);
  require_options(options);
  const auto start = std::chrono::steady_clock::now();
  Router router(graph, options);
  const auto islands = components(graph);
  for (std::size_t k = 0; k < islands.size(); ++k) {
    report(progress, "routing", static_cast<double>(k) / static_cast<double>(islands.size()));
    router.route_island(islands[k]);
  }
  RoutingResult result = router.finish();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

PartitionInterval partition_by_milp(const ModuleGraph& graph, int capacity, double time_limit_s) {
  require_joints(graph);
  const auto start = std::chrono::steady_clock::now();
  PartitionInterval interval;
  bool found_all = true;
  for (const auto& island : components(graph)) {
    const LocalGraph g = localize(graph, island);
    const MilpAnswer answer = divide_by_milp(g, capacity, (g.size() + capacity - 1) / capacity, time_limit_s);
    interval.lower += answer.lower_bound;
    interval.upper += answer.parts;
    found_all = found_all && answer.parts > 0;
  }
  if (!found_all) interval.upper = 0;
  interval.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return interval;
}

}  // namespace triskin::geometry
