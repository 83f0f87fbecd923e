// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/make_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "choose_layout.hpp"
#include "design_in_work.hpp"
#include "growth_step.hpp"
#include "later_steps.hpp"
#include "pieces_step.hpp"
#include "searched_surface.hpp"
#include "surface_step.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mesh/extract_steps.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

// Without a surface nothing can be covered, so repair may take much of a short limit.
constexpr double kRepairShare = 0.4, kShortRepair_s = 2.0, kShortRepairShare = 0.7;
constexpr double kPiecesShare = 0.3;
// Until the first layout is there to measure them on, the steps after the growth keep these shares of the limit free.
constexpr double kPricingShare = 0.05, kWiringShare = 0.1;
constexpr const char* kWritingStep = "writing";

void require_places(const design::KindPlan& plan) {
  if (std::ranges::all_of(plan.regions, [](const auto& r) { return design::is_place(r.region); })) return;
  throw InputError(
      "kinds: a region names modules or an island, which have numbers only when the design is there; make it without "
      "--kinds, then run triskin edit DESIGN --kinds");
}

// Limits of the lattice for a bending radius: a side of a module is a chord, whose sagitta is a²/(8R)
// (docs/limits.md).
DesignOptions with_bend_limits(DesignOptions options) {
  if (options.bend_radius_mm <= 0.0) return options;
  const double sagitta_mm = design::kSide_mm * design::kSide_mm / (8.0 * options.bend_radius_mm);
  options.limits.depth_mm = std::min(options.limits.depth_mm, sagitta_mm);
  options.limits.lift_mm = std::min(options.limits.lift_mm, sagitta_mm);
  return options;
}

DesignInWork begun(const std::filesystem::path& mesh, const DesignOptions& given, const ProgressSink& progress) {
  require_places(given.kinds);
  DesignInWork work{mesh, with_bend_limits(given), progress, TimeBudget(given.time_limit_s), {}, {}};
  work.design.name = mesh.stem().string();
  work.design.source_file = mesh.filename().string();
  work.design.seed = work.options.seed;
  work.design.limits = work.options.limits;
  work.design.price = work.options.price;
  work.design.kinds = work.options.kinds;
  return work;
}

// An older version of the part gives the places of its modules; only the rest of the surface is searched.
void revise(DesignInWork& work) {
  RevisedDesign revised = work.budget.run("revising", 1.0, [&](double end_s) {
    const double left_s = std::max(0.1, end_s - work.budget.used_s());
    return revise_design(*work.options.like, std::move(work.design),
                         {left_s, work.options.iterations, work.options.threads}, work.progress);
  });
  work.design = std::move(revised.design);
  work.notes.revision = std::move(revised.revision);
}

// All layouts that were found, with their price, most valuable first.
std::vector<WiredLayout> search_layouts(DesignInWork& work, const mesh::Surface& surface,
                                        const mesh::SurfaceRegions* regions) {
  const SearchedSurface searched(surface, work.options);
  work.notes.solver_faces = static_cast<int>(searched.surface().mesh().faces.size());
  work.notes.solver_deviation_mm = searched.solver() == nullptr ? 0.0 : searched.solver()->deviation_mm;
  work.budget.reserve(kPricingStep, kPricingShare * work.budget.limit_s());
  work.budget.reserve(kWiringStep, kWiringShare * work.budget.limit_s());
  std::vector<WiredLayout> choices;
  if (are_pieces_tried(work, searched.surface())) {
    work.budget.run("pieces", kPiecesShare,
                    [&](double end_s) { choices = layouts_on_pieces(work, searched, regions, end_s); });
  }
  std::vector<design::ModuleLayout> grown =
      work.budget.run("growth", 1.0, [&](double end_s) { return grown_layouts(work, searched, regions, end_s); });
  work.notes.surface = static_cast<int>(grown[0].modules.size());
  report(work.progress, kPricingStep, -1.0, counted(grown.size(), "layout"));
  work.budget.run(kPricingStep, 1.0, [&](double end_s) {
    routing::RoutingOptions routing = routing_options(work.design);
    routing.threads = work.options.threads;
    routing.give_up = work.deadline(end_s);
    std::ranges::move(priced(surface, std::move(grown), work.options.limits, routing, regions, work.options.threads),
                      std::back_inserter(choices));
  });
  std::ranges::stable_sort(choices, std::greater{}, &WiredLayout::value);
  return choices;
}

void take_best(DesignInWork& work, std::vector<WiredLayout>& choices, const mesh::Surface& surface,
               const mesh::SurfaceRegions* regions) {
  design::Design& design = work.design;
  design.alternatives = front_of(choices);
  design.layout = std::move(choices[0].layout);
  for (std::size_t k = 0; k < design.alternatives.size(); ++k) {
    if (design.alternatives[k].layout.modules.size() == design.layout.modules.size())
      design.taken = static_cast<int>(k);
  }
  design::assign_kinds_by_place(design.kinds, design.layout);
  wire(design, surface, regions, choices[0].places, work.progress, choices[0].division);
}

void cover(DesignInWork& work) {
  const mesh::Surface surface(work.design.surface);
  const auto regions = regions_of(surface, work.design);
  std::vector<WiredLayout> choices = search_layouts(work, surface, regions.get());
  work.budget.run(kWiringStep, 1.0, [&](double) { take_best(work, choices, surface, regions.get()); });
}

// The whole skin of an adult has 1.5 to 2 m². More on one part is rather a wrong unit than a wish, and a search for
// hundreds of controllers; only the person knows.
void ask_about_area(const DesignInWork& work, double unit_mm) {
  constexpr double kAskedArea_mm2 = 1.5e6;
  const double area_mm2 = mesh::area_of(work.design.surface);
  if (area_mm2 <= kAskedArea_mm2 || work.options.unit) return;
  const double modules = area_mm2 / design::kModuleArea_mm2;
  throw InputError(fmt::format(
      "{}: {:.1f} m² are more than the skin of a person (1.5 m²), for up to {:.0f} modules and {:.0f} "
      "controllers; is one of its numbers {:g} mm? Then confirm it with --unit {}, or give the right one; --object, "
      "--side and --face choose less",
      work.mesh.string(), area_mm2 * 1e-6, modules, std::ceil(modules / design::kModulesAController), unit_mm,
      unit_mm == 25.4     ? "in"
      : unit_mm == 1000.0 ? "m"
      : unit_mm == 10.0   ? "cm"
                          : "mm"));
}

// Runs the steps up to the first that decides the answer.
void run_steps(DesignInWork& work) {
  TimeBudget& budget = work.budget;
  const mesh::MeshFile file = budget.run("reading", 1.0, [&](double) { return read_part(work); });
  // The design holds the surface, and writing it takes no longer than reading it did.
  budget.reserve(kWritingStep, budget.used_s());
  // On a surface smaller than a module nothing fits, whatever its faces do, and that is an answer.
  if (const double area_mm2 = mesh::area_of(file.mesh); area_mm2 < design::kModuleArea_mm2) {
    work.design.surface = file.mesh;
    work.design.report.area_cm2 = area_mm2 / 100.0;
    return;
  }
  const double limit_s = budget.limit_s();
  const double repaired_s = std::max(kRepairShare * limit_s, std::min(kShortRepair_s, kShortRepairShare * limit_s));
  const bool is_decided =
      budget.run("repairing", kRepairShare, [&](double) { return make_surface(work, file, repaired_s); });
  if (!is_decided) return;
  ask_about_area(work, file.report.scale_to_mm);
  if (work.options.like != nullptr)
    revise(work);
  else
    cover(work);
}

}  // namespace

DesignResult make_design(const std::filesystem::path& mesh, const DesignOptions& given, const ProgressSink& progress) {
  DesignInWork work = begun(mesh, given, progress);
  run_steps(work);
  work.design.report.seconds = work.budget.used_s();
  work.notes.steps = work.budget.steps();
  return {std::move(work.design), std::move(work.notes)};
}

}  // namespace triskin::pipeline
