// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "bus_report.hpp"
#include "command.hpp"
#include "corner_cut_option.hpp"
#include "design_edit.hpp"
#include "face_options.hpp"
#include "mesh_options.hpp"
#include "part_text.hpp"
#include "read_text.hpp"
#include "repair_text.hpp"
#include "sharp_joints_text.hpp"
#include "side_option.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/interrupt.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/design/supply.hpp"
#include "triskin/exports/revision_picture.hpp"
#include "triskin/pipeline/make_design.hpp"
#include "verbosity.hpp"
#include "why_few.hpp"

namespace triskin::cli::design_command {
namespace {

struct Options {
  std::string mesh, output, regions, like, kinds;
  UnitOption unit;
  SideOption side;
  FaceOptions faces;
  pipeline::DesignOptions design;
  Verbosity verbosity;
};

nlohmann::json steps_json(const std::vector<pipeline::StepTime>& steps) {
  nlohmann::json list = nlohmann::json::array();
  for (const pipeline::StepTime& s : steps)
    list.push_back({{"step", s.name}, {"granted_s", s.granted_s}, {"used_s", s.used_s}});
  return list;
}

design::Vec3 size_of(const design::Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const design::Vec3& v : mesh.vertices) box.extend(v);
  return mesh.vertices.empty() ? design::Vec3(0, 0, 0) : design::Vec3(box.sizes());
}

nlohmann::json keys_of(const design::Design& d, const pipeline::DesignNotes& notes) {
  const auto& r = d.report;
  nlohmann::json refused = nlohmann::json::object(), supply_v = nlohmann::json::array();
  for (const layout::PatchIndex p : design::patches_of(d))
    supply_v.push_back(design::lowest_supply(d, d.patches[static_cast<std::size_t>(p)]).volts);
  const design::Vec3 size_mm = size_of(d.surface);
  for (const auto& [limit, count] : d.layout.refused) refused[limit] = count;
  nlohmann::json keys = {{"modules", d.layout.modules.size()},
                         {"upper_bound", r.upper_bound},
                         {"coverage", r.coverage},
                         {"pieces", d.pieces.size()},
                         {"islands", d.layout.islands},
                         {"patches", design::patches_of(d).size()},
                         {"patches_lower_bound", r.patches_lower_bound},
                         {"jumpers", d.layout.jumpers.size()},
                         {"jumpers_lower_bound", r.jumpers_lower_bound},
                         {"supply_v", std::move(supply_v)},
                         {"max_edge_error_mm", r.max_edge_error_mm},
                         {"max_hinge_gap_mm", r.max_hinge_gap_mm},
                         {"max_center_gap_mm", r.max_center_gap_mm},
                         {"max_edge_lift_mm", r.max_edge_lift_mm},
                         {"max_edge_depth_mm", r.max_edge_depth_mm},
                         {"method", design::kLayoutMethodNames.name(d.layout.method)},
                         {"modules_pieces", notes.pieces},
                         {"modules_surface", notes.surface},
                         {"pieces_left_out", notes.pieces_left_out},
                         {"curvature_rad", notes.curvature_rad},
                         {"steps", steps_json(notes.steps)},
                         {"refused", refused},
                         {"repair", mesh::kRepairNames.name(notes.extract.repair)},
                         {"enclosed_components", notes.extract.enclosed_components},
                         {"deviation_mm", notes.extract.deviation.largest_mm},
                         {"deviation_found_mm", notes.extract.deviation.found_mm},
                         {"reduced_mm", notes.extract.reduced_mm},
                         {"crossing_tested", notes.extract.tested},
                         {"solver_faces", notes.solver_faces},
                         {"solver_deviation_mm", notes.solver_deviation_mm},
                         {"notes", notes.reading},
                         {"size_mm", {size_mm.x(), size_mm.y(), size_mm.z()}},
                         {"seconds", r.seconds}};
  if (d.layout.corner_cut_mm > 0.0) {
    keys["corner_cut_mm"] = d.layout.corner_cut_mm;
    keys["coverage_cut"] = r.coverage_cut;
  }
  return keys;
}

// Prints what a person has to know before using the design.
void say_warnings(const design::Design& d, const pipeline::DesignNotes& notes, Output& output) {
  for (const std::string& note : notes.reading) output.say(note);
  if (const std::string shortage = shortage_text(notes.extract); !shortage.empty()) output.say(shortage);
  if (const std::string change = repair_text(notes.extract, "repair"); !change.empty()) output.say(change);
  if (const std::string side = side_text(notes.side); !side.empty()) output.say(side);
  if (const std::string holes = bridge_text(notes.bridges); !holes.empty()) output.say(holes);
  if (notes.pieces_left_out > 0) {
    output.say(fmt::format("no time was left for {}; a longer --time-limit-s may give more modules",
                           counted(notes.pieces_left_out, "piece")));
  }
  if (d.layout.corner_cut_mm > 0.0) say_cut_pads(d.layout.corner_cut_mm, output);
}

void say_layout(const design::Design& d, Output& output) {
  const auto& r = d.report;
  const std::string cut = d.layout.corner_cut_mm > 0.0 ? fmt::format(", {:.1f} % with corners cut by {:g} mm",
                                                                     100.0 * r.coverage_cut, d.layout.corner_cut_mm)
                                                       : "";
  const design::Vec3 size_mm = size_of(d.surface);
  output.say(
      fmt::format("{}: {:.0f} cm², {:.1f} × {:.1f} × {:.1f} mm, {} placed (at most {} by area), coverage {:.1f} %{}",
                  d.name, r.area_cm2, size_mm.x(), size_mm.y(), size_mm.z(), counted(d.layout.modules.size(), "module"),
                  r.upper_bound, 100.0 * r.coverage, cut));
  output.say(fmt::format("{} (lower bound {}), {} (lower bound {}), {}",
                         counted(design::patches_of(d).size(), "controller"), r.patches_lower_bound,
                         counted(d.layout.jumpers.size(), "jumper"), r.jumpers_lower_bound,
                         counted(d.layout.islands, "island")));
}

std::string method_text(const design::Design& d, const pipeline::DesignNotes& notes) {
  const bool pieces_tried = std::ranges::find(notes.steps, "pieces", &pipeline::StepTime::name) != notes.steps.end();
  return pieces_tried
             ? fmt::format("pieces give {}, growth on the surface {}: {} taken", counted(notes.pieces, "module"),
                           notes.surface, design::kLayoutMethodNames.name(d.layout.method))
             : fmt::format(
                   "grown on the surface; flat pieces were not tried (curvature under a module: "
                   "{:.1f}°; --method pieces tries them)",
                   notes.curvature_rad * 180.0 / std::numbers::pi);
}

// With -v, explains how the result was found.
void say_details(const design::Design& d, const pipeline::DesignNotes& notes, Output& output) {
  const auto& r = d.report;
  const std::string open_side = notes.side.choice.has_wall ? "" : side_text_of(mesh::open_side_of(d.surface));
  if (!open_side.empty()) output.say(open_side);
  for (const layout::PatchIndex p : design::patches_of(d)) {
    const design::Patch& patch = d.patches[static_cast<std::size_t>(p)];
    const design::LowestSupply lowest = design::lowest_supply(d, patch);
    double most_ohm = 1e9, least_ohm = 0.0;
    for (const design::LineElectrical& line : patch.lines) {
      if (line.modules == 0) continue;
      least_ohm = std::max(least_ohm, line.pull_up_min_ohm);
      most_ohm = std::min(most_ohm, line.pull_up_max_ohm);
    }
    output.say(fmt::format(
        "patch {}: supply {:.2f} V at module {}, the lowest (needed: {:.2f}); pull-ups of {:.0f} … {:.0f} Ω", p,
        lowest.volts, design::number_of(d, lowest.module), design::SupplyModel{}.needed_v(), least_ohm, most_ohm));
  }
  if (notes.solver_deviation_mm > 0.0) {
    output.say(fmt::format("searched on {} of {}, which deviate by at most {:.3f} mm; measured on all",
                           notes.solver_faces, counted(d.surface.faces.size(), "face"), notes.solver_deviation_mm));
  }
  output.say(fmt::format(
      "edge error ≤ {:.2f} mm, hinge gap ≤ {:.2f} mm, centre gap ≤ {:.2f} mm, sides lift ≤ {:.2f} mm, "
      "depth ≤ {:.2f} mm",
      r.max_edge_error_mm, r.max_hinge_gap_mm, r.max_center_gap_mm, r.max_edge_lift_mm, r.max_edge_depth_mm));
  output.say(method_text(d, notes));
  std::vector<std::string> steps;
  for (const pipeline::StepTime& s : notes.steps) steps.push_back(fmt::format("{} {:.1f} s", s.name, s.used_s));
  output.say(fmt::format("time: {}", fmt::join(steps, ", ")));
  for (const auto& [limit, count] : d.layout.refused)
    output.say(fmt::format("{} refused {}", limit, counted(count, "further module")));
}

// Reports the modules that stayed, and draws the changes as a picture beside the design.
void report_revision(const design::Design& old, const design::Design& d, const pipeline::Revision& revision,
                     const std::string& design_file, Output& output) {
  const std::string picture = design_file + ".changes.svg";
  write_output(picture, exports::revision_svg(old, d, revision.new_id, revision.added));
  output.result["revision"] = {{"picture", picture}};
  report_labels(old, d, output.result["revision"], output);
  output.say(picture + " shows what changed");
  report_tables(old, d, revision.kept_patches, output.result["revision"], output);
}

// Turns what the options name into what the pipeline takes.
void read_files(Options& options) {
  options.design.unit = options.unit.unit;
  options.design.faces = options.faces.selection();
  if (!options.regions.empty()) options.design.regions = design::read_region_file(options.regions);
  options.design.kinds = kind_plan_of(options.kinds);
  options.design.side = options.side.options();
  options.design.bridge_mm = options.side.bridge_mm();
  if (!options.like.empty())
    options.design.like = std::make_shared<const design::Design>(design::read_design(options.like));
}

// Reports a design that was written; returns false if a region is not covered as it must be.
bool report_design(const design::Design& d, const pipeline::DesignNotes& notes, const Options& options,
                   Output& output) {
  say_layout(d, output);
  if (interrupt_signal() > 0)
    output.say(fmt::format("stopped early; the best layout so far, with {}, is kept",
                           counted(d.layout.modules.size(), "module")));
  if (notes.revision) report_revision(*options.design.like, d, *notes.revision, options.output, output);
  report_kinds(d, output);
  const bool is_covered = report_regions(d, output);
  output.say(fmt::format("design {:016x} written to {} in {:.1f} s", d.design_id, options.output, d.report.seconds));
  if (const std::string low = low_coverage_text(d); !low.empty()) output.say(low);
  report_alternatives(d, output);
  if (options.verbosity.verbose) {
    say_details(d, notes, output);
    report_bus(d.layout.modules.size(), output);
  } else {
    add_bus_keys(d.layout.modules.size(), output);
  }
  return is_covered;
}

// Returns false, with what to choose, if the repair moved the surface farther than modules may be off it, or if hardly
// any of the surface could be covered: a design of another part than the one that was meant is no success.
bool is_the_part(const design::Design& d, const pipeline::DesignNotes& notes, Output& output) {
  constexpr int kFewOfBound = 20;  // Covers that were meant are above a third of the bound by area.
  const double moved_mm = notes.extract.deviation.found_mm;
  const bool has_moved = moved_mm > d.limits.center_gap_mm;
  if (has_moved)
    output.say(fmt::format(
        "The repair moved the surface by up to {:.1f} mm, more than a module may be off it ({:g} mm): this is no "
        "longer the part. Choose a body (--body, --object) or a side (--side), repair the mesh, or try --repair never",
        moved_mm, d.limits.center_gap_mm));
  const int modules = static_cast<int>(d.layout.modules.size());
  const bool is_little = kFewOfBound * modules < d.report.upper_bound;
  if (is_little)
    output.say(
        fmt::format("Only {} of {} by area: choose the body (--body, --object) or side (--side) to cover, or repair "
                    "the mesh",
                    counted(modules, "module"), d.report.upper_bound));
  return !has_moved && !is_little;
}

// The limit ends the search. What follows grows with the part, and no rule may stay unchecked for it.
void say_time_beyond(double limit_s, double took_s, std::size_t modules, const Output& output) {
  constexpr double kNoticed_s = 2.0;
  if (limit_s <= 0.0 || took_s < limit_s + kNoticed_s || took_s < 1.5 * limit_s) return;
  output.say(
      fmt::format("It took {:.1f} s: --time-limit-s {:g} limits the search; reading, wiring, the check of every rule "
                  "and the file of {} take the rest",
                  took_s, limit_s, counted(modules, "module")));
}

int run(Options options, Output& output) {
  catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  require_design_output(options.output);
  options.verbosity.apply(output);
  read_files(options);
  auto [d, notes] = pipeline::make_design(options.mesh, options.design, output.progress());
  if (notes.side.is_undecided) return report_undecided(notes.part, notes.side, options.output + ".svg", output);
  const bool nothing = d.layout.modules.empty();
  std::optional<OutputCheck> check;
  // The modules of an older design have numbers that must hold, so none is taken away.
  if (!nothing)
    check = write_checked_design(options.output, d, notes.revision ? OnViolation::kRefuse : OnViolation::kRemoveModules,
                                 output.progress());
  output.result = keys_of(d, notes);
  if (check) {
    report_check(*check, output);
    report_sharp_joints(check->report, output);
  }
  add_side_keys(notes.side, output);
  if (options.design.bridge_mm > 0.0) output.result["bridged_holes"] = notes.bridges.bridged;
  const int part_status = report_part(notes.read, output);
  say_warnings(d, notes, output);
  if (nothing) {
    const std::string reason = reason_of_nothing(d, options.unit.unit.has_value(), output);
    output.result["reason"] = reason;
    output.say(reason);
    return 1;
  }
  const bool is_covered = report_design(d, notes, options, output);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  say_time_beyond(options.design.time_limit_s, took.count(), d.layout.modules.size(), output);
  return is_the_part(d, notes, output) && is_covered && check->keeps_all_rules() ? part_status : 1;
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
  app.add_option("--fold-rad", l.fold_rad, "limit of the angle at a joint; boards bend by 0.87 (docs/fabrication.md)")
      ->check(CLI::Range(0.01, 3.0))
      ->capture_default_str();
  app.add_option("--fold-away-rad", l.fold_away_rad, "limit at a joint over a ridge (none: as --fold-rad)")
      ->check(CLI::Range(0.01, 3.0));
  app.add_option("--fold-towards-rad", l.fold_towards_rad, "limit at a joint in a valley (none: as --fold-rad)")
      ->check(CLI::Range(0.01, 3.0));
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

// Adds options for the costs of a layout, in modules, and for the length of jumpers.
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

// These values are already determined by the older design.
void require_like_alone(const CLI::App& app) {
  if (app.get_option("--like")->count() == 0) return;
  for (const char* name :
       {"--edge-error-mm", "--hinge-gap-mm", "--center-gap-mm", "--fold-rad", "--penetration-mm", "--overrun-mm",
        "--lift-mm", "--depth-mm", "--jumper-mm", "--controller-cost", "--jumper-cost", "--island-cost", "--seed",
        "--kinds", "--corner-cut-mm", "--bend-radius-mm", "--solver-deviation-mm", "--method"}) {
    if (app.get_option(name)->count() > 0)
      throw InputError(
          fmt::format("{} has no effect with --like, whose design says it; leave it out, or make the design "
                      "without --like",
                      name));
  }
}

void add_files(CLI::App& app, Options& o) {
  app.add_option("MESH", o.mesh,
                 "OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF, STEP or IGES; mm unless --unit says otherwise")
      ->required();
  app.add_option("-o,--output", o.output, "design file")->required();
  add_kinds(app, o.kinds);
  app.add_option("--like", o.like,
                 "design of an older version of the part: keeps its modules where they still fit, and its limits, "
                 "price, seed and kinds")
      ->check(CLI::ExistingFile);
  app.add_option("--repair", o.design.repair, "repair self-intersecting or non-manifold meshes, or refuse them")
      ->transform(one_of(std::map<std::string, pipeline::RepairMode>{{"auto", pipeline::RepairMode::kAuto},
                                                                     {"never", pipeline::RepairMode::kNever}}));
}

void add_search(CLI::App& app, Options& o) {
  app.add_option("--time-limit-s", o.design.time_limit_s,
                 "time limit of the search; check and file of a large part take more")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  app.add_option("--method", o.design.method,
                 "where layouts are searched: lattice (on the surface), pieces (on flat pieces too), auto (on pieces "
                 "only if the surface is nearly developable)")
      ->transform(one_of(std::map<std::string, pipeline::SearchMethod>{{"auto", pipeline::SearchMethod::kAuto},
                                                                       {"pieces", pipeline::SearchMethod::kPieces},
                                                                       {"lattice", pipeline::SearchMethod::kLattice}}));
  app.add_option("--seed", o.design.seed, "random seed")->capture_default_str();
  o.unit.add_to(app);
  add_object_option(app, o.design.object);
  o.side.add_to(app);
  app.add_flag("--flip", o.design.flip, "turn all faces over: the other side of an open part");
  o.faces.add_to(app);
}

void add_rules(CLI::App& app, Options& o) {
  add_limits(app, o.design.limits);
  add_corner_cut(app, o.design.corner_cut_mm);
  app.add_option("--bend-radius-mm", o.design.bend_radius_mm,
                 "smallest bending radius of a module; limits depth and lift to 112.5/radius (0: no limit)")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
  app.add_option("--solver-deviation-mm", o.design.solver_deviation_mm,
                 "largest deviation of the simplified mesh that is searched (0: search the surface itself)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--regions", o.regions,
                 "file with weights, keep-outs and places that must be covered (docs/regions.md)")
      ->check(CLI::ExistingFile);
  add_price(app, o.design.limits, o.design.price);
  o.verbosity.add_to(app);
  app.add_option("--threads", o.design.threads, "threads of the search; the result depends on their number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--iterations", o.design.iterations,
                 "steps of each thread (0: as the time permits); makes the result repeatable")
      ->check(CLI::Range(0, 1000000000))
      ->capture_default_str();
}

const Registration kDesign{{
    "design",
    "cover a mesh with modules: surface, layout, controllers, wiring",
    "triskin design forearm.obj -o forearm.design.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      add_files(app, *options);
      add_search(app, *options);
      add_rules(app, *options);
      return [options, &app](Output& output) {
        require_like_alone(app);
        return run(*options, output);
      };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::design_command
