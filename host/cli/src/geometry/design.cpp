// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>

#include "corner_cut_option.hpp"
#include "mesh_options.hpp"
#include "triskin/cli/command.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string mesh, output;
  UnitOption unit;
  pipeline::DesignOptions design;
};

int run(Options options, Output& output) {
  options.design.unit = options.unit.unit;
  pipeline::MethodComparison methods;
  const design::Design d = pipeline::make_design(options.mesh, options.design, output.progress(), &methods);
  design::write_design(options.output, d);
  const auto& r = d.report;
  nlohmann::json refused = nlohmann::json::object();
  for (const auto& [limit, count] : d.layout.refused) refused[limit] = count;
  output.result = {{"modules", d.layout.modules.size()},
                   {"upper_bound", r.upper_bound},
                   {"coverage", r.coverage},
                   {"pieces", d.pieces.size()},
                   {"islands", d.layout.islands},
                   {"patches", d.patches.size()},
                   {"patches_lower_bound", r.patches_lower_bound},
                   {"max_edge_error_mm", r.max_edge_error_mm},
                   {"max_hinge_gap_mm", r.max_hinge_gap_mm},
                   {"max_center_gap_mm", r.max_center_gap_mm},
                   {"method", design::kLayoutMethodNames.name(d.layout.method)},
                   {"modules_pieces", methods.pieces},
                   {"modules_surface", methods.surface},
                   {"refused", refused},
                   {"seconds", r.seconds}};
  if (d.layout.corner_cut_mm > 0.0) {
    output.result["corner_cut_mm"] = d.layout.corner_cut_mm;
    output.result["coverage_cut"] = r.coverage_cut;
  }
  output.say(fmt::format("{}: {:.0f} cm², {} modules placed (at most {} by area), coverage {:.1f} %", d.name,
                         r.area_cm2, d.layout.modules.size(), r.upper_bound, 100.0 * r.coverage));
  if (d.layout.corner_cut_mm > 0.0) {
    output.say(fmt::format("corners cut by {:g} mm: coverage {:.1f} % of cut modules", d.layout.corner_cut_mm,
                           100.0 * r.coverage_cut));
    say_cut_pads(d.layout.corner_cut_mm, output);
  }
  output.say(
      fmt::format("{} islands, {} patches (lower bound {}); edge error ≤ {:.2f} mm, hinge gap ≤ {:.2f} mm, "
                  "centre gap ≤ {:.2f} mm",
                  d.layout.islands, d.patches.size(), r.patches_lower_bound, r.max_edge_error_mm, r.max_hinge_gap_mm,
                  r.max_center_gap_mm));
  output.say(fmt::format("pieces give {} modules, growth on the surface {}: {} taken", methods.pieces, methods.surface,
                         design::kLayoutMethodNames.name(d.layout.method)));
  for (const auto& [limit, count] : d.layout.refused)
    output.say(fmt::format("  {} refused {} further modules", limit, count));
  output.say(fmt::format("design {:016x} written to {} in {:.1f} s", d.design_id, options.output, r.seconds));
  return 0;
}

const Registration kDesign{{
    "design",
    "cover a mesh with modules: surface, layout, controllers, wiring",
    "triskin design forearm.obj -o forearm.design.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("MESH", options->mesh, "OBJ, STL, PLY, OFF or DAE; mm unless --unit says otherwise")->required();
      app.add_option("-o,--output", options->output, "design file")->required();
      app.add_option("--time-limit-s", options->design.time_limit_s, "effort")
          ->check(CLI::Range(0.01, 1e6))
          ->capture_default_str();
      app.add_option("--seed", options->design.seed, "of every random choice")->capture_default_str();
      options->unit.add_to(app);
      auto& l = options->design.limits;
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
      add_corner_cut(app, options->design.corner_cut_mm);
      app.add_option("--bend-radius-mm", options->design.bend_radius_mm,
                     "part the pieces from what bends more than this, as the reference paper does at 50 (0: no)")
          ->check(CLI::Range(0.0, 1e4))
          ->capture_default_str();
      app.add_option("--island-cost", options->design.island_cost,
                     "modules that an island is worth beside its controllers: 0 most modules, 0.5 few islands")
          ->check(CLI::Range(0.0, 16.0))
          ->capture_default_str();
      app.add_option("--controller-cost", options->design.controller_cost,
                     "modules that a controller is worth (an island needs one for every 16 modules)")
          ->check(CLI::Range(0.0, 16.0))
          ->capture_default_str();
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
}  // namespace triskin::cli
