// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "triskin/cli/command.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/host/files.hpp"
#include "triskin/model/module_list.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string modules;
  std::string output;
  geometry::RoutingOptions routing;
};

nlohmann::json patches_json(const geometry::RoutingResult& result, const std::vector<int>& ids) {
  const auto id = [&](int node) { return node < 0 ? -1 : ids[static_cast<std::size_t>(node)]; };
  nlohmann::json patches = nlohmann::json::array();
  for (const geometry::Patch& p : result.patches) {
    nlohmann::json modules = nlohmann::json::array();
    for (const geometry::RoutedModule& m : p.modules) {
      modules.push_back({{"id", id(m.node)}, {"parent", id(m.parent)}, {"rotation", m.rotation}, {"line", m.line},
                         {"address", m.address}, {"depth", m.depth}});
    }
    nlohmann::json cut = nlohmann::json::array();
    for (const auto& [a, b] : p.cut_joints) cut.push_back({id(a), id(b)});
    nlohmann::json failures = nlohmann::json::array();
    for (const geometry::FailureLoss& f : p.failures) {
      nlohmann::json backup = nlohmann::json::array();
      for (const auto& [child, parent] : f.backup_tree) backup.push_back({id(child), id(parent)});
      failures.push_back({{"module", id(f.node)}, {"other", id(f.other_node)}, {"lost_strapped", f.lost_strapped},
                          {"lost_rerouted", f.lost_rerouted}, {"backup", std::move(backup)}});
    }
    patches.push_back({{"entry", id(p.entry)}, {"modules", std::move(modules)}, {"cut_joints", std::move(cut)},
                       {"line_hops", p.line_hops}, {"max_depth", p.max_depth}, {"failures", std::move(failures)}});
  }
  return patches;
}

int run(const Options& options, Output& output) {
  const model::ModuleList list = model::read_module_list(options.modules);
  const geometry::RoutingResult r = geometry::route(list.graph, options.routing, output.progress());
  output.result = {{"patches", r.patches.size()}, {"lower_bound", r.lower_bound}, {"proved", r.proved},
                   {"line_hops", r.line_hops},    {"max_depth", r.max_depth},     {"mean_loss", r.mean_loss},
                   {"seconds", r.seconds},        {"routes", patches_json(r, list.ids)}};
  if (!options.output.empty()) write_file_atomically(options.output, output.result.dump() + "\n");
  output.say(fmt::format("{} modules on {} controllers, lower bound {}{}; {} line hops, depth {}, mean loss {:.2f} modules; {:.3f} s",
                         list.ids.size(), r.patches.size(), r.lower_bound, r.proved ? " (proved fewest)" : "", r.line_hops,
                         r.max_depth, r.mean_loss, r.seconds));
  return 0;
}

const Registration kRoute{{
    "route", "divide modules into the fewest controllers and wire each one", "triskin route modules.json -o routes.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("MODULES", options->modules, "module list (JSON): {\"modules\":[{\"id\":0,\"i\":3,\"j\":5,\"up\":true}, …]}")->required();
      app.add_option("-o,--output", options->output, "write the routes to this file");
      app.add_option("--seed", options->routing.seed, "of the random trees")->capture_default_str();
      app.add_option("--time-limit-s", options->routing.time_limit_s, "per island")->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
