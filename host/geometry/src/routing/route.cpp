// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "partition.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/host/error.hpp"
#include "wiring.hpp"

namespace triskin::geometry {
namespace {

void require_symmetric(const ModuleGraph& graph) {
  const int n = static_cast<int>(graph.nodes.size());
  for (int v = 0; v < n; ++v) {
    for (const int w : graph.nodes[static_cast<std::size_t>(v)].neighbour) {
      if (w < 0) continue;
      const bool back = w < n && w != v && std::ranges::count(graph.nodes[static_cast<std::size_t>(w)].neighbour, v) > 0;
      if (!back) throw InputError(fmt::format("module {}: joined to {}, which is not joined to it", v, w));
    }
  }
}

}  // namespace

RoutingResult route(const ModuleGraph& graph, const RoutingOptions& options, const ProgressSink& progress) {
  require_symmetric(graph);
  const auto start = std::chrono::steady_clock::now();
  RoutingResult result;
  const auto islands = components(graph);
  for (std::size_t k = 0; k < islands.size(); ++k) {
    report(progress, "routing", static_cast<double>(k) / static_cast<double>(islands.size()));
    const Partition p = partition(graph, islands[k], options.capacity, options.seed, options.time_limit_s);
    result.lower_bound += p.lower_bound;
    for (const auto& part : p.parts) result.patches.push_back(wire(graph, part, options));
  }
  double loss = 0.0;
  int failures = 0;
  for (Patch& patch : result.patches) {
    result.line_hops += patch.line_hops;
    result.max_depth = std::max(result.max_depth, patch.max_depth);
    if (!options.failure_analysis) continue;
    analyse_failures(graph, patch);
    for (const FailureLoss& f : patch.failures) {
      loss += f.lost_rerouted;
      ++failures;
    }
  }
  result.mean_loss = failures > 0 ? loss / failures : 0.0;
  result.proved = static_cast<int>(result.patches.size()) == result.lower_bound;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace triskin::geometry
