// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth_step.hpp"

#include <algorithm>

#include "choose_layout.hpp"
#include "later_steps.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

// A growth that begins late still gets this share of the limit, so that there is a layout.
constexpr double kMinShare = 0.1;
// With a shorter limit all time goes into one layout: alternatives would cost modules.
constexpr double kAlternativesFrom_s = 3.0;

// Prices a layout once, and reserves what pricing and wiring the final ones will take.
void measure_later_steps(DesignInWork& work, const SearchedSurface& searched, const mesh::SurfaceRegions* regions,
                         const design::ModuleLayout& first) {
  routing::RoutingOptions routing = routing_options(work.design);
  routing.threads = work.options.threads;
  const double begin_s = work.budget.used_s();
  (void)priced(searched.original(), first, work.options.limits, routing, regions);
  reserve_later_steps(work.budget, work.budget.used_s() - begin_s, routing.threads);
}

}  // namespace

std::vector<design::ModuleLayout> grown_layouts(DesignInWork& work, const SearchedSurface& searched,
                                                const mesh::SurfaceRegions* regions, double end_s) {
  const DesignOptions& options = work.options;
  const double begin_s = work.budget.used_s();
  const double min_s = kMinShare * options.time_limit_s;
  lattice::SurfaceLatticeOptions lattice;
  lattice.seed = options.seed;
  lattice.iterations = options.iterations;
  lattice.corner_cut_mm = options.corner_cut_mm;
  lattice.threads = options.threads;
  lattice.price = options.price;
  lattice.regions = regions;
  lattice.solver = searched.solver();
  lattice.front = options.iterations > 0 || options.time_limit_s > kAlternativesFrom_s;
  const double with_front = lattice.front ? 1.0 + lattice::kFrontTimeShare : 1.0;
  lattice.time_limit_s = std::max(min_s, (end_s - begin_s) / with_front);
  lattice.first_layout = [&](const design::ModuleLayout& first) {
    measure_later_steps(work, searched, regions, first);
    return std::max(min_s, (work.budget.used_s() - begin_s + work.budget.left_s()) / with_front);
  };
  return lattice::grow_front(searched.original(), options.limits, lattice, work.progress);
}

}  // namespace triskin::pipeline
