// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <memory>

#include "corner_cut_option.hpp"
#include "mesh_options.hpp"
#include "repair_text.hpp"
#include "triskin/cli/bus_report.hpp"
#include "triskin/cli/command.hpp"
#include "triskin/host/interrupt.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli::design_command {
namespace {

struct Options {
  std::string mesh, output, regions;
  UnitOption unit;
  pipeline::DesignOptions design;
  int take = -1;
};

// What the regions got. False: a place that must be covered is not.
bool report_regions(const design::Design& d, Output& output) {
  if (d.regions.empty()) return true;
  output.result["worth"] = d.report.worth;
  output.result["uncovered"] = nlohmann::json::array();
  output.say(fmt::format("{} regions: the modules are worth {:.2f}", d.regions.list.size(), d.report.worth));
  for (const design::Uncovered& u : d.report.uncovered) {
    const auto& p = u.place_mm;
    const std::string why = u.why == "room" ? "a module fits there, but not beside the others" : u.why + " refuses any";
    output.result["uncovered"].push_back(
        {{"region", u.region}, {"share", u.share}, {"place_mm", {p.x(), p.y(), p.z()}}, {"why", u.why}});
    output.say(
        fmt::format("  region \"{}\" must be covered, {:.1f} % of it is not: farthest from a module is "
                    "({:.1f}, {:.1f}, {:.1f}); {}",
                    u.region, 100.0 * u.share, p.x(), p.y(), p.z(), why));
  }
  return d.report.uncovered.empty();
}

// Modules against price, the layout that is taken marked.
void report_alternatives(const design::Design& d, Output& output) {
  output.result["price"] =
      d.price.of(static_cast<int>(d.patches.size()), static_cast<int>(d.layout.jumpers.size()), d.layout.islands);
  output.result["taken"] = d.taken;
  output.result["alternatives"] = nlohmann::json::array();
  for (std::size_t k = 0; k < d.alternatives.size(); ++k) {
    const design::Alternative& a = d.alternatives[k];
    const std::size_t n = a.layout.modules.size();
    output.result["alternatives"].push_back({{"modules", n},
                                             {"patches", a.patches},
                                             {"jumpers", a.jumpers},
                                             {"islands", a.layout.islands},
                                             {"price", a.price},
                                             {"worth", a.worth}});
    output.say(
        fmt::format("{} alternative {}: {} modules, {} controllers, {} jumpers, {} islands: price {:.2f}, value {:.2f}",
                    static_cast<int>(k) == d.taken ? "*" : " ", k, n, a.patches, a.jumpers, a.layout.islands, a.price,
                    a.worth - a.price));
  }
}

int take(const Options& options, Output& output) {
  const design::Design d =
      pipeline::take_alternative(design::read_design(options.mesh), options.take, output.progress());
  design::write_design(options.output, d);
  output.result = {{"modules", d.layout.modules.size()}, {"islands", d.layout.islands},
                   {"patches", d.patches.size()},        {"patches_lower_bound", d.report.patches_lower_bound},
                   {"jumpers", d.layout.jumpers.size()}, {"jumpers_lower_bound", d.report.jumpers_lower_bound},
                   {"coverage", d.report.coverage},      {"seconds", d.report.seconds}};
  const bool is_covered = report_regions(d, output);
  report_alternatives(d, output);
  output.say(fmt::format("design {:016x} written to {}", d.design_id, options.output));
  return is_covered ? 0 : 1;
}

// Why nothing fits: most often the mesh is in another unit than the one it was read in.
std::string reason_of_nothing(const design::Design& d, bool unit_given) {
  design::Vec3 low = design::Vec3::Constant(1e300), high = -low;
  for (const auto& v : d.surface.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const design::Vec3 size = d.surface.vertices.empty() ? design::Vec3::Zero() : design::Vec3(high - low);
  return fmt::format(
      "no module fits: the surface measures {:.4g} × {:.4g} × {:.4g} mm, a module is a triangle with sides of "
      "30 mm{}; no design was written",
      size.x(), size.y(), size.z(),
      unit_given ? "" : "; the mesh was taken for mm: say --unit cm or --unit m if it is not");
}

nlohmann::json keys_of(const design::Design& d, const pipeline::DesignNotes& notes) {
  const auto& r = d.report;
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [limit, count] : d.layout.refused) refused[limit] = count;
  nlohmann::json keys = {{"modules", d.layout.modules.size()},
                         {"upper_bound", r.upper_bound},
                         {"coverage", r.coverage},
                         {"pieces", d.pieces.size()},
                         {"islands", d.layout.islands},
                         {"patches", d.patches.size()},
                         {"patches_lower_bound", r.patches_lower_bound},
                         {"jumpers", d.layout.jumpers.size()},
                         {"jumpers_lower_bound", r.jumpers_lower_bound},
                         {"max_edge_error_mm", r.max_edge_error_mm},
                         {"max_hinge_gap_mm", r.max_hinge_gap_mm},
                         {"max_center_gap_mm", r.max_center_gap_mm},
                         {"max_edge_lift_mm", r.max_edge_lift_mm},
                         {"max_edge_depth_mm", r.max_edge_depth_mm},
                         {"method", design::kLayoutMethodNames.name(d.layout.method)},
                         {"modules_pieces", notes.pieces},
                         {"modules_surface", notes.surface},
                         {"refused", refused},
                         {"repair", geometry::kRepairNames.name(notes.extract.repair)},
                         {"deviation_mm", notes.extract.deviation.largest_mm},
                         {"seconds", r.seconds}};
  if (d.layout.corner_cut_mm > 0.0) {
    keys["corner_cut_mm"] = d.layout.corner_cut_mm;
    keys["coverage_cut"] = r.coverage_cut;
  }
  return keys;
}

void say_layout(const design::Design& d, const pipeline::DesignNotes& notes, Output& output) {
  const auto& r = d.report;
  if (const std::string change = repair_text(notes.extract); !change.empty()) output.say(change);
  output.say(fmt::format("{}: {:.0f} cm², {} modules placed (at most {} by area), coverage {:.1f} %", d.name,
                         r.area_cm2, d.layout.modules.size(), r.upper_bound, 100.0 * r.coverage));
  if (d.layout.corner_cut_mm > 0.0) {
    output.say(fmt::format("corners cut by {:g} mm: coverage {:.1f} % of cut modules", d.layout.corner_cut_mm,
                           100.0 * r.coverage_cut));
    say_cut_pads(d.layout.corner_cut_mm, output);
  }
  output.say(fmt::format(
      "{} islands, {} patches (lower bound {}), {} jumpers (lower bound {}); edge error ≤ {:.2f} mm, hinge "
      "gap ≤ {:.2f} mm, centre gap ≤ {:.2f} mm, sides lift ≤ {:.2f} mm, depth ≤ {:.2f} mm",
      d.layout.islands, d.patches.size(), r.patches_lower_bound, d.layout.jumpers.size(), r.jumpers_lower_bound,
      r.max_edge_error_mm, r.max_hinge_gap_mm, r.max_center_gap_mm, r.max_edge_lift_mm, r.max_edge_depth_mm));
  output.say(fmt::format("pieces give {} modules, growth on the surface {}: {} taken", notes.pieces, notes.surface,
                         design::kLayoutMethodNames.name(d.layout.method)));
  for (const auto& [limit, count] : d.layout.refused)
    output.say(fmt::format("  {} refused {} further modules", limit, count));
}

int run(Options options, Output& output) {
  if (options.take >= 0) return take(options, output);
  catch_interrupts();
  options.design.unit = options.unit.unit;
  if (!options.regions.empty()) options.design.regions = design::read_region_file(options.regions);
  pipeline::DesignNotes notes;
  const design::Design d = pipeline::make_design(options.mesh, options.design, output.progress(), &notes);
  const bool nothing = d.layout.modules.empty();
  if (!nothing) design::write_design(options.output, d);
  output.result = keys_of(d, notes);
  say_layout(d, notes, output);
  if (nothing) {
    const std::string reason = reason_of_nothing(d, options.unit.unit.has_value());
    output.result["reason"] = reason;
    output.say(reason);
    return 1;
  }
  if (interrupt_signal() > 0)
    output.say(fmt::format("ended before its time: the best layout so far, with {} modules, is kept",
                           d.layout.modules.size()));
  const bool is_covered = report_regions(d, output);
  report_alternatives(d, output);
  report_bus(d.layout.modules.size(), output);
  output.say(fmt::format("design {:016x} written to {} in {:.1f} s", d.design_id, options.output, d.report.seconds));
  return is_covered ? 0 : 1;
}

void add_limits(CLI::App& app, design::LayoutLimits& l) {
  app.add_option("--edge-error-mm", l.edge_error_mm, "limit of a module's edge error")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app.add_option("--hinge-gap-mm", l.hinge_gap_mm, "limit between joined corners")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app.add_option("--center-gap-mm", l.center_gap_mm, "limit under a module's centre")
      ->check(CLI::Range(0.01, 20.0))
      ->capture_default_str();
  app.add_option("--fold-rad", l.fold_rad, "limit of the angle at a joint")
      ->check(CLI::Range(0.01, 3.0))
      ->capture_default_str();
  app.add_option("--penetration-mm", l.penetration_mm, "limit of two modules' overlap")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app.add_option("--overrun-mm", l.overrun_mm, "limit over the border")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app.add_option("--lift-mm", l.lift_mm, "limit of corners and sides above the surface")
      ->check(CLI::Range(0.01, 50.0))
      ->capture_default_str();
  app.add_option("--depth-mm", l.depth_mm, "limit of corners and sides under the surface")
      ->check(CLI::Range(0.01, 50.0))
      ->capture_default_str();
}

// What a layout costs, in modules, and how long a jumper may be.
void add_price(CLI::App& app, design::LayoutLimits& l, design::Price& price) {
  app.add_option("--jumper-mm", l.jumper_mm, "limit of a jumper's length along the surface (0: no jumpers)")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--controller-cost", price.controller, "modules that a controller with its cable is worth")
      ->check(CLI::Range(0.0, 16.0))
      ->capture_default_str();
  app.add_option("--jumper-cost", price.jumper, "modules that a jumper is worth")
      ->check(CLI::Range(0.0, 16.0))
      ->capture_default_str();
  app.add_option("--island-cost", price.island, "modules that an island is worth; all costs 0: most modules")
      ->check(CLI::Range(0.0, 16.0))
      ->capture_default_str();
}

const Registration kDesign{{
    "design",
    "cover a mesh with modules: surface, layout, controllers, wiring",
    "triskin design forearm.obj -o forearm.design.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("MESH", options->mesh,
                     "OBJ, STL, PLY, OFF, DAE, glTF, GLB or 3MF; mm unless --unit says otherwise; with --take a design")
          ->required();
      app.add_option("-o,--output", options->output, "design file")->required();
      app.add_option("--take", options->take, "MESH is a design: take its alternative of this number, without a search")
          ->check(CLI::Range(0, 1000));
      app.add_option("--repair", options->design.repair,
                     "auto: a mesh that crosses itself or is no manifold is made one that can be covered; never: it is "
                     "refused")
          ->transform(one_of(std::map<std::string, pipeline::RepairMode>{{"auto", pipeline::RepairMode::kAuto},
                                                                         {"never", pipeline::RepairMode::kNever}}));
      app.add_option("--time-limit-s", options->design.time_limit_s, "effort")
          ->check(CLI::Range(0.01, 1e6))
          ->capture_default_str();
      app.add_option("--seed", options->design.seed, "of every random choice")->capture_default_str();
      options->unit.add_to(app);
      add_limits(app, options->design.limits);
      add_corner_cut(app, options->design.corner_cut_mm);
      app.add_option("--bend-radius-mm", options->design.bend_radius_mm,
                     "part the pieces from what bends more than this, as the reference paper does at 50 (0: no)")
          ->check(CLI::Range(0.0, 1e4))
          ->capture_default_str();
      app.add_option("--regions", options->regions,
                     "file of weights, keep-outs and places that must be covered (docs/regions.md)")
          ->check(CLI::ExistingFile);
      add_price(app, options->design.limits, options->design.price);
      app.add_option("--threads", options->design.threads, "chains of the growth; part of what a result depends on")
          ->check(CLI::Range(1, 256))
          ->capture_default_str();
      app.add_option("--iterations", options->design.iterations,
                     "steps of each chain (0: as the time permits); repeatable when the time suffices")
          ->check(CLI::Range(0, 1000000000))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::design_command
