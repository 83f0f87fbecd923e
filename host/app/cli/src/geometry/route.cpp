// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/check/routing_rules.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/json_value.hpp"
#include "triskin/design/module_list.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/exports/route_picture.hpp"
#include "triskin/exports/skingui.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::cli::route_command {
namespace {

struct Options {
  std::string modules;
  std::string output;
  std::string module_output;
  std::string picture;
  std::string checked;  // The file contains routes to check instead of solving.
  bool skingui = false;
  std::string part;
  bool hops_first = false;
  double jumpers_mm = 0.0;  // A positive value requires that MODULES is a design.
  double time_limit_s = 0.0;
  routing::RoutingOptions routing;
};

using Ids = std::vector<int>;
int id_of(const Ids& ids, int node) {
  return node < 0 ? -1 : ids[static_cast<std::size_t>(node)];
}

nlohmann::json pairs_json(const std::vector<std::array<int, 2>>& pairs, const Ids& ids) {
  nlohmann::json result = nlohmann::json::array();
  for (const auto& [a, b] : pairs) result.push_back({id_of(ids, a), id_of(ids, b)});
  return result;
}

nlohmann::json failures_json(const design::Patch& patch, const Ids& ids) {
  nlohmann::json failures = nlohmann::json::array();
  for (const design::FailureLoss& f : patch.failures) {
    failures.push_back({{"module", id_of(ids, f.node)},
                        {"other", id_of(ids, f.other_node)},
                        {"lost_strapped", f.lost_strapped},
                        {"lost_rerouted", f.lost_rerouted},
                        {"lost_one_entry", f.lost_one_entry},
                        {"lost_backed_up", f.lost_backed_up},
                        {"backup", pairs_json(f.backup_tree, ids)},
                        {"adopted", pairs_json(f.adopted, ids)}});
  }
  return failures;
}

nlohmann::json lines_json(const design::Patch& patch) {
  nlohmann::json lines = nlohmann::json::array();
  for (const design::LineElectrical& l : patch.lines) {
    lines.push_back({{"modules", l.modules},
                     {"capacitance_pf", l.capacitance_pf},
                     {"rise_time_ns", l.rise_time_ns},
                     {"max_bus_hz", l.max_bus_hz},
                     {"pull_up_min_ohm", l.pull_up_min_ohm},
                     {"pull_up_max_ohm", l.pull_up_max_ohm}});
  }
  return lines;
}

nlohmann::json modules_json(const design::Patch& p, const Ids& ids) {
  nlohmann::json modules = nlohmann::json::array();
  for (const design::RoutedModule& m : p.modules) {
    modules.push_back({{"id", id_of(ids, m.node)},
                       {"parent", id_of(ids, m.parent)},
                       {"rotation", m.rotation},
                       {"line", m.line},
                       {"address", m.address},
                       {"depth", m.depth}});
  }
  return modules;
}

nlohmann::json patches_json(const routing::RoutingResult& result, const Ids& ids) {
  nlohmann::json patches = nlohmann::json::array();
  for (const design::Patch& p : result.patches) {
    nlohmann::json articulation = nlohmann::json::array();
    for (const int v : p.articulation) articulation.push_back(id_of(ids, v));
    patches.push_back({{"entry", id_of(ids, p.entry)},
                       {"border_entry", p.border_entry},
                       {"second_entry", id_of(ids, p.second_entry)},
                       {"second_entry_side", p.second_entry_side},
                       {"second_entry_border", p.second_entry_border},
                       {"second_entry_saves", p.second_entry_saves},
                       {"modules", modules_json(p, ids)},
                       {"cut_joints", pairs_json(p.cut_joints, ids)},
                       {"line_hops", p.line_hops},
                       {"max_depth", p.max_depth},
                       {"failures", failures_json(p, ids)},
                       {"articulation", std::move(articulation)},
                       {"bridges", pairs_json(p.bridges, ids)},
                       {"lines", lines_json(p)},
                       {"electrical_violations", p.electrical_violations}});
  }
  return patches;
}

nlohmann::json result_json(const routing::RoutingResult& r, const Ids& ids) {
  return {{"patches", r.patches.size()},
          {"lower_bound", r.lower_bound},
          {"proved", r.proved},
          {"proof", routing::kPartitionProofNames.name(r.proof)},
          {"line_hops", r.line_hops},
          {"max_depth", r.max_depth},
          {"mean_loss", r.mean_loss},
          {"mean_loss_one_entry", r.mean_loss_one_entry},
          {"mean_loss_strapped", r.mean_loss_strapped},
          {"patches_without_border", r.patches_without_border},
          {"electrical_violations", r.electrical_violations},
          {"seconds", r.seconds},
          {"routes", patches_json(r, ids)}};
}

// Returns the possible jumpers over the seams of a design, whose modules have slits. Only a design has the positions of
// modules in space.
std::vector<design::Jumper> jumper_places(const std::string& path, double jumpers_mm, design::ModuleList& list) {
  design::Design design = design::read_design(path);
  design.layout.jumpers.clear();
  design.limits.jumper_mm = jumpers_mm;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k) {
    list.ids.push_back(design::number_of(design, static_cast<int>(k)).value);
    list.tiles.push_back(design.layout.modules[k].tile);
  }
  list.graph = design::graph_of(design.layout);
  return routing::find_jumpers(mesh::Surface(design.surface), design.layout, design.limits);
}

nlohmann::json jumpers_json(const std::vector<design::Jumper>& jumpers, const Ids& ids) {
  nlohmann::json result = nlohmann::json::array();
  for (const design::Jumper& j : jumpers)
    result.push_back(
        {{"modules", {id_of(ids, j.node[0]), id_of(ids, j.node[1])}}, {"sides", j.side}, {"length_mm", j.length_mm}});
  return result;
}

int report_check(const check::DesignReport& report, Output& output) {
  output.result["rules"] = report.rules.size();
  output.result["violations"] = nlohmann::json::array();
  for (const check::Violation& v : report.violations) {
    output.result["violations"].push_back({{"rule", v.rule}, {"where", v.where}, {"text", v.text}});
    output.say(fmt::format("{}: {}: {}", v.rule, v.where, v.text));
  }
  return report.violations.empty() ? 0 : 1;
}

/// Holds what is routed: the modules, and the places of jumpers where those are wanted.
struct Task {
  exports::SkinGuiLayout layout;
  std::vector<design::Jumper> places;
};

Task read_task(const Options& options) {
  if (!options.part.empty() && !options.skingui)
    throw InputError("--part: names a part of a skinGui collection; give --skingui too");
  if (options.jumpers_mm > 0.0 && (options.skingui || !options.checked.empty()))
    throw InputError("--jumper-mm: needs a design file, which alone knows where the sides lie in space");
  Task task;
  if (options.jumpers_mm > 0.0)
    task.places = jumper_places(options.modules, options.jumpers_mm, task.layout.list);
  else if (options.skingui)
    task.layout = exports::read_skingui(options.modules, options.part);
  else
    task.layout.list = design::read_module_list(options.modules);
  return task;
}

int check_file(const Options& options, const design::ModuleList& list, Output& output) {
  const nlohmann::json routes = design::parse_json(read_text(options.checked), options.checked);
  const int status = report_check(check::check_routes(exports::module_list_json(list), routes), output);
  output.say(fmt::format("{}, {}", counted(output.result["rules"].get<int>(), "rule"),
                         counted(output.result["violations"].size(), "violation")));
  return status;
}

routing::RoutingOptions routing_options(const Options& options) {
  routing::RoutingOptions routing = options.routing;
  if (options.hops_first) routing.objective = routing::RouteObjective::kHopsFirst;
  if (options.time_limit_s > 0.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.time_limit_s);
    routing.give_up = [end] { return std::chrono::steady_clock::now() > end; };
  }
  return routing;
}

/// Routes the modules without jumpers as well, to say what the jumpers save.
void report_jumpers(const Options& options, const Task& task, const routing::RoutingResult& with,
                    routing::RoutingOptions count_only, Output& output) {
  count_only.failure_analysis = false;
  count_only.recombinations = 0;
  const routing::RoutingResult apart = routing::route(task.layout.list.graph, count_only);
  output.say(fmt::format("{} (at least {}) of {} up to {:g} mm: {} instead of {}, lower bound {} instead of {}",
                         counted(with.jumpers.size(), "jumper"), with.jumpers_lower_bound,
                         counted(task.places.size(), "place"), options.jumpers_mm,
                         counted(with.patches.size(), "controller"), apart.patches.size(), with.lower_bound,
                         apart.lower_bound));
  output.result["patches_without_jumpers"] = apart.patches.size();
  output.result["lower_bound_without_jumpers"] = apart.lower_bound;
  output.result["jumpers"] = jumpers_json(with.jumpers, task.layout.list.ids);
  output.result["jumpers_lower_bound"] = with.jumpers_lower_bound;
  output.result["jumper_places"] = task.places.size();
  output.result["price_proved"] = with.price_proved;
}

/// Says what was found. Returns the exit status: 1 if a line is too heavy.
int report_routes(const routing::RoutingResult& r, std::size_t modules, double bus_hz, Output& output) {
  output.say(
      fmt::format("{} on {}, lower bound {}{}; {}, depth {}; {:.3f} s", counted(modules, "module"),
                  counted(r.patches.size(), "controller"), r.lower_bound,
                  r.proved ? fmt::format(" (proved fewest by {})", routing::kPartitionProofNames.name(r.proof)) : "",
                  counted(r.line_hops, "line hop"), r.max_depth, r.seconds));
  output.say(fmt::format("mean extra loss of a single failure: {:.2f} modules; one entry {:.2f}; strapped {:.2f}",
                         r.mean_loss, r.mean_loss_one_entry, r.mean_loss_strapped));
  if (r.patches_without_border > 0)
    output.say(fmt::format("{} {} no border side: their cables pass through the skin",
                           counted(r.patches_without_border, "patch"),
                           agreeing(r.patches_without_border, "has", "have")));
  if (r.electrical_violations == 0) return 0;
  output.say(fmt::format("{} {} too heavy for {:g} kHz", counted(r.electrical_violations, "line"),
                         agreeing(r.electrical_violations, "is", "are"), bus_hz / 1e3));
  return 1;
}

int run(const Options& options, Output& output) {
  const Task task = read_task(options);
  const design::ModuleList& list = task.layout.list;
  if (!options.module_output.empty())
    write_output(options.module_output, exports::module_list_json(list).dump() + "\n");
  if (!options.checked.empty()) return check_file(options, list, output);
  const routing::RoutingOptions routing = routing_options(options);
  const routing::RoutingResult r = routing::route(list.graph, task.places, routing, output.progress());
  output.result = result_json(r, list.ids);
  if (options.jumpers_mm > 0.0) report_jumpers(options, task, r, routing, output);
  if (options.skingui) {
    output.result["boards_today"] = task.layout.boards;
    output.result["boards_apart_today"] = task.layout.boards_apart;
  }
  if (!options.picture.empty()) write_output(options.picture, exports::route_svg(list, r.patches));
  if (!options.output.empty()) write_output(options.output, output.result.dump() + "\n");
  if (options.skingui)
    output.say(fmt::format("today {}, {} of them with triangles that do not hang together",
                           counted(task.layout.boards, "board"), task.layout.boards_apart));
  return report_routes(r, list.ids.size(), routing.electrical.bus_hz, output);
}

void add_search_options(CLI::App& app, Options& o) {
  app.add_option("--seed", o.routing.seed, "of the random trees")->capture_default_str();
  app.add_option("--time-limit-s", o.time_limit_s, "end the search for fewer controllers after this long; 0: no limit")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--moves", o.routing.recombinations, "recombination moves a patch, against loss and depth")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.add_flag("--hops-first", o.hops_first, "least line hops before least expected loss");
  app.add_option("--cable-m", o.routing.electrical.cable_m, "length of the entry cable")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
}

void add_options(CLI::App& app, Options& o) {
  app.add_option("MODULES", o.modules,
                 "module list (JSON): "
                 "{\"modules\":[{\"id\":0,\"i\":3,\"j\":5,\"up\":true}, …]}")
      ->required();
  app.add_option("-o,--output", o.output, "write the routes to this file");
  app.add_option("--check", o.checked,
                 "check this file of routes against MODULES instead of solving; exit 1 when a rule is broken");
  app.add_flag("--skingui", o.skingui, "MODULES is a skinGui configuration, or with --part a JSON collection of them");
  app.add_option("--part", o.part, "part of the collection, e.g. torso");
  app.add_option("--write-modules", o.module_output, "write the module list that was read to this file");
  app.add_option("--jumper-mm", o.jumpers_mm,
                 "MODULES is a design; jumpers up to this long may join its islands where that saves controllers")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--jumper-cost", o.routing.price.jumper, "price of a jumper")
      ->check(CLI::Range(0.0, 16.0))
      ->capture_default_str();
  app.add_option("--controller-cost", o.routing.price.controller, "price of a controller, to weigh jumpers against")
      ->check(CLI::Range(0.0, 16.0))
      ->capture_default_str();
  app.add_option("--picture", o.picture, "draw the routes to this file (SVG)");
  add_search_options(app, o);
}

const Registration kRoute{{
    "route",
    "divide modules into the fewest controllers and wire each one",
    "triskin route modules.json -o routes.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_options(app, *options);
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::route_command
