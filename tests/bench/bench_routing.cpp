// SPDX-License-Identifier: GPL-3.0-or-later
// Measures speed against error of the partition and the wiring: time and gap against the number of modules, by shape.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "bench.hpp"
#include "milp.hpp"
#include "plan/routing/src/random_patch.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::cli {
namespace {

using routing::PatchShape;

constexpr std::array kShapes{PatchShape::kCompact, PatchShape::kStrip, PatchShape::kHoled, PatchShape::kDendritic};
const char* name_of(PatchShape shape) {
  constexpr std::array kNames{"compact", "strip", "holed", "dendritic"};
  return kNames[static_cast<std::size_t>(shape)];
}

// Measures several patches of one shape and size: how many are proved, and how long the slowest takes.
nlohmann::json row(PatchShape shape, int modules, int patches) {
  int proved = 0, widest_gap = 0;
  double seconds = 0.0, processor = 0.0, slowest_s = 0.0, loss = 0.0, loss_strapped = 0.0;
  for (int seed = 0; seed < patches; ++seed) {
    const auto patch = routing::random_patch(shape, modules, static_cast<std::uint64_t>(seed));
    const double start = processor_s();
    const routing::RoutingResult r = routing::route(patch.graph);
    processor += processor_s() - start;
    proved += r.proved ? 1 : 0;
    widest_gap = std::max(widest_gap, static_cast<int>(r.patches.size()) - r.lower_bound);
    seconds += r.seconds;
    slowest_s = std::max(slowest_s, r.seconds);
    loss += r.mean_loss;
    loss_strapped += r.mean_loss_strapped;
  }
  return {{"shape", name_of(shape)},
          {"modules", modules},
          {"cases", patches},
          {"proved", proved},
          {"widest_gap", widest_gap},
          {"slowest_s", slowest_s},
          {"mean_loss", loss / patches},
          {"mean_loss_strapped", loss_strapped / patches},
          {"processor_s", processor / patches},
          {"seconds", seconds / patches}};
}

// Solves the same patch by the integer programme alone and by all steps, in one run.
nlohmann::json milp_row(PatchShape shape, int modules, double time_limit_s) {
  const auto patch = routing::random_patch(shape, modules, 1);
  routing::RoutingOptions options;
  options.failure_analysis = false;
  options.recombinations = 0;
  double start = processor_s();
  const routing::RoutingResult all = routing::route(patch.graph, options);
  const double seconds = processor_s() - start;
  start = processor_s();
  const bench::PartitionInterval milp = bench::partition_by_milp(patch.graph, options.capacity, time_limit_s);
  const double milp_s = processor_s() - start;
  return {{"shape", name_of(shape)},
          {"modules", modules},
          {"patches", all.patches.size()},
          {"lower_bound", all.lower_bound},
          {"milp_patches", milp.upper},
          {"milp_lower_bound", milp.lower},
          {"milp_s", milp_s},
          {"ratio_to_milp", milp_s / seconds},
          {"seconds", seconds}};
}

// Controllers and jumpers of a generated cover together, by all steps and by the integer programme.
nlohmann::json jumper_row(const char* shape, double size_mm, double time_limit_s) {
  const Scratch scratch;
  const std::filesystem::path file = scratch.path() / "part.obj";
  mesh::write_mesh(file, mesh::generate(*mesh::shape_named(shape), {.size_mm = size_mm, .faces = 0}));
  pipeline::DesignOptions wanted;
  wanted.iterations = 20;
  wanted.threads = 1;
  wanted.time_limit_s = 1e4;
  design::Design design = pipeline::make_design(file, wanted).design;
  const auto places = routing::find_jumpers(mesh::Surface(design.surface), design.layout, design.limits);
  design.layout.jumpers.clear();
  const design::ModuleGraph graph = design::graph_of(design.layout);
  routing::RoutingOptions options;
  options.failure_analysis = false;
  options.recombinations = 0;
  const double start = processor_s();
  const routing::RoutingResult all = routing::route(graph, places, options);
  const double seconds = processor_s() - start;
  const double before = processor_s();
  const bench::PriceInterval milp = bench::price_by_milp(graph, places, options.capacity, options.price, time_limit_s);
  const double milp_s = processor_s() - before;
  return {{"series", "jumpers"},
          {"shape", shape},
          {"modules", graph.nodes.size()},
          {"islands", design.layout.islands},
          {"places", places.size()},
          {"controllers", all.patches.size()},
          {"jumpers", all.jumpers.size()},
          {"price", options.price.of(static_cast<int>(all.patches.size()), static_cast<int>(all.jumpers.size()), 0)},
          {"price_proved", all.price_proved},
          {"milp_lower", milp.lower},
          {"milp_upper", std::isfinite(milp.upper) ? nlohmann::json(milp.upper) : nlohmann::json()},
          {"milp_processor_s", milp_s},
          {"ratio_to_milp", milp_s / seconds},
          {"processor_s", seconds}};
}

nlohmann::json rows(const BenchOptions& options, Output& output) {
  nlohmann::json result = nlohmann::json::array();
  for (const PatchShape shape : kShapes) {
    for (const int modules : {38, 80, 142, 240, 600, 1200, 2600}) {
      if (options.quick && modules > 600) continue;
      const int cases = modules > 600 ? 1 : options.quick ? 5 : 20;
      result.push_back(row(shape, modules, cases));
      output.say(fmt::format("{:9} {:5} modules: {} of {} proved, widest gap {}, {:.4f} s", name_of(shape), modules,
                             result.back()["proved"].get<int>(), cases, result.back()["widest_gap"].get<int>(),
                             result.back()["seconds"].get<double>()));
    }
  }
  if (options.quick) result.push_back(row(PatchShape::kCompact, 2600, 1));
  for (const auto& [shape, size_mm] : {std::pair("hip", 160.0), std::pair("torso", 130.0), std::pair("forearm", 200.0)})
    result.push_back(jumper_row(shape, size_mm, options.quick ? 4.0 : 20.0));
  for (const int modules : options.quick ? std::vector{20, 38, 60} : std::vector{38, 80, 142}) {
    result.push_back(milp_row(PatchShape::kCompact, modules, options.quick ? 4.0 : 120.0));
    output.say(fmt::format("CBC alone, {:3} modules: [{}, {}] in {:.1f} s; here {:.4f} s", modules,
                           result.back()["milp_lower_bound"].get<int>(), result.back()["milp_patches"].get<int>(),
                           result.back()["milp_s"].get<double>(), result.back()["seconds"].get<double>()));
  }
  return result;
}

const BenchSubject kRouting{"routing", "partition into controllers: time and gap against size, CBC beside it", rows};

}  // namespace
}  // namespace triskin::cli
