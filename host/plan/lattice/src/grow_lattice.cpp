// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/lattice/grow_lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "canonical.hpp"
#include "certify.hpp"
#include "chain.hpp"
#include "kept_modules.hpp"
#include "team.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/parallel.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::lattice {
namespace {

constexpr int kStepsARound = 64;      // Each chain takes this many steps between two reports.
constexpr int kRoundsAnExchange = 2;  // The chains exchange their best layout after this many rounds.
// With room for this many modules, a chain of a team is worth its thread. With fewer, the bands of its zone leave
// little room, and they separate islands (HEAD with four zones of 64 is worth less than with two).
constexpr double kModulesAChain = 90.0;
constexpr std::size_t kMore = 8;     // We certify at most this many other layouts that have as many modules.
constexpr std::size_t kThinned = 5;  // We make this many smaller layouts from the best one.
constexpr double kSampleArea_mm2 = 50.0;
// The corners of the rigid module stand off a little more than those of the lattice, so the lattice gets 70 % of the
// limit.
constexpr double kLiftShare = 0.7;

Grower::Clock::duration duration_of(double s) {
  return std::chrono::duration_cast<Grower::Clock::duration>(std::chrono::duration<double>(s));
}

void check_options(const LayoutLimits& l, const SurfaceLatticeOptions& o) {
  if (!(o.time_limit_s > 0.0)) throw InputError("lattice: the time limit must be positive");
  if (o.threads < 1 || o.threads > 256) throw InputError("lattice: the number of threads must be 1 … 256");
  if (o.iterations < 0) throw InputError("lattice: the number of iterations must not be negative");
  for (const double cost : {o.price.island, o.price.controller, o.price.jumper, o.hinge_reward}) {
    if (!(cost >= 0.0 && cost <= 16.0))
      throw InputError(
          "lattice: the cost of an island, controller or jumper and the reward of a joint must be 0 … 16 modules");
  }
  if (!(o.corner_cut_mm >= 0.0 && o.corner_cut_mm <= design::kMaxCornerCut_mm))
    throw InputError(fmt::format("lattice: the corner cut must be 0 … {} mm", design::kMaxCornerCut_mm));
  if (!(o.corner_lift_mm >= 0.0)) throw InputError("lattice: the corner lift must not be negative");
  for (const double v : {l.edge_error_mm, l.hinge_gap_mm, l.center_gap_mm, l.fold_rad, l.penetration_mm, l.overrun_mm,
                         l.lift_mm, l.depth_mm, l.fold_away_rad, l.fold_towards_rad}) {
    if (!(v > 0.0)) throw InputError("lattice: every limit must be positive");
  }
}

const Chain& best_of(const std::deque<Chain>& chains) {
  return *std::ranges::max_element(chains,
                                   [](const Chain& a, const Chain& b) { return a.best_value() < b.best_value(); });
}

// Returns the best of all chains for each number of modules, most modules first, then the most valuable of the others,
// with as many modules on more or fewer islands; omits the best of all, which is kept anyway.
std::vector<const LatticeMesh*> front_of(const std::deque<Chain>& chains) {
  std::map<std::pair<int, int>, const FoundLayout*, std::greater<>> found;
  for (const Chain& chain : chains) {
    for (const auto& [numbers, of_chain] : chain.front().found()) {
      const FoundLayout*& best = found[numbers];
      if (best == nullptr || of_chain.value > best->value) best = &of_chain;
    }
  }
  const LatticeMesh* const best = best_of(chains).best().get();
  std::vector<const FoundLayout*> by_value;
  for (const auto& [numbers, of_numbers] : found) {
    if (numbers.first >= best->size() - kFront && of_numbers->net.get() != best) by_value.push_back(of_numbers);
  }
  std::ranges::stable_sort(by_value, std::greater{}, &FoundLayout::value);
  std::map<int, const LatticeMesh*, std::greater<>> by_size;
  std::vector<const LatticeMesh*> more;
  for (const FoundLayout* f : by_value) {
    const LatticeMesh* const net = f->net.get();
    const bool is_first = net->size() != best->size() && by_size.try_emplace(net->size(), net).second;
    if (!is_first && more.size() < kMore) more.push_back(net);
  }
  std::vector<const LatticeMesh*> nets;
  for (const auto& [size, net] : by_size) nets.push_back(net);
  nets.insert(nets.end(), more.begin(), more.end());
  return nets;
}

// Shows the caller the first layout, and takes the time limit that it answers with.
void show_first(GrowthTask& task, const Certifier& certifier, std::deque<Chain>& chains) {
  if (!task.options.first_layout || task.options.iterations > 0) return;
  const LatticeMesh& first = *best_of(chains).best();
  if (first.size() == 0) return;
  task.end = task.start + duration_of(task.options.first_layout(certifier.other(first)));
  for (Chain& c : chains) c.end_at(task.end);
}

// Runs rounds of all teams side by side until time or steps are over.
void search(GrowthTask& task, const Certifier& certifier, std::deque<Chain>& chains, int max_in_a_team,
            const ProgressSink& progress) {
  const int iterations = task.options.iterations;
  const auto each = [](auto& items, const auto& work) {
    in_parallel(static_cast<int>(items.size()), items.size(), [&](std::size_t k) { work(items[k]); });
  };
  each(chains, [](Chain& c) { c.build(); });
  show_first(task, certifier, chains);
  std::vector<Team> teams = teams_of(task, chains, max_in_a_team);
  const Chain& leader = chains.front();
  for (int round = 1; task.now() < task.end && !interrupt_request() && (iterations == 0 || leader.steps() < iterations);
       ++round) {
    const int steps = iterations == 0 ? kStepsARound : std::min(kStepsARound, iterations - leader.steps());
    each(teams, [](Team& t) { t.divide_work(); });
    each(chains, [steps](Chain& c) { c.run(steps); });
    each(teams, [](Team& t) { t.merge(); });
    const Chain& best = best_of(chains);
    report(progress, "lattice", task.fraction(leader.steps()),
           fmt::format("{} modules in {} islands", best.best()->size(), best.best()->islands()));
    if (round % kRoundsAnExchange != 0) continue;
    for (Team& t : teams) t.catch_up(best);
  }
}

// Counts, for the report, the limits that refuse further modules; if a module fits after all, it is kept.
void count_refusals(const GrowthTask& task, LatticeMesh& net, ModuleLayout& layout) {
  Dice random(task.options.seed);
  Grower grower(task.surface, task.rules, task.samples, task.corner_lift_mm, Grower::Clock::time_point::max());
  grower.grow(net, {}, random);
  for (std::size_t k = 1; k < kRefusals; ++k) {
    if (grower.refused[k] > 0) layout.refused.emplace_back(name_of(static_cast<Refusal>(k)), grower.refused[k]);
  }
}

// Appends layouts made from the best one, with fewer islands and a controller less, and the others that were found, as
// far as time allows.
void certify_others(const GrowthTask& task, const Certifier& certifier, const LatticeMesh& best,
                    const std::vector<const LatticeMesh*>& found, std::vector<ModuleLayout>& layouts) {
  // One controller less can read this many modules.
  const int full = (best.size() - 1) / kModulesAController * kModulesAController;
  const std::vector<LatticeMesh> less = thinned(best, full, kThinned);
  std::vector<const LatticeMesh*> others;
  for (const LatticeMesh& l : less) others.push_back(&l);
  others.insert(others.end(), found.begin(), found.end());
  std::vector<std::optional<ModuleLayout>> front(others.size());
  const auto end = task.end + duration_of(kFrontTimeShare * task.options.time_limit_s);
  in_parallel(task.options.threads, others.size(), [&](std::size_t k) {
    if (task.options.iterations > 0 || task.now() < end) front[k] = certifier.other(*others[k]);
  });
  for (std::optional<ModuleLayout>& layout : front) {
    if (layout) layouts.push_back(std::move(*layout));
  }
}

}  // namespace

double corner_lift_of(const LayoutLimits& limits, const SurfaceLatticeOptions& options) {
  return std::min(options.corner_lift_mm, kLiftShare * limits.lift_mm);
}

std::vector<ModuleLayout> grow_front(const mesh::Surface& original, const LayoutLimits& limits,
                                     const SurfaceLatticeOptions& options, const ProgressSink& progress) {
  check_options(limits, options);
  const auto start = options.now ? options.now() : Grower::Clock::now();
  const CanonicalCopy copy(options.solver == nullptr ? original.mesh() : options.solver->mesh);
  const mesh::Surface surface(copy.mesh());
  const auto end = start + duration_of(options.time_limit_s);
  const CopiedRegions regions(options.regions, copy);
  const LayoutLimits searched = options.solver == nullptr ? limits : mesh::limits_on(*options.solver, limits);
  const Rules rules(surface, searched, regions.free_points());
  const std::vector<Sample> samples = spread_samples(surface, kSampleArea_mm2, options.seed);
  const LatticeMesh started = net_of_kept(surface, copy, options.kept, options.corner_cut_mm);
  const double room = surface.area_mm2() / kModuleArea_mm2;
  GrowthTask task{surface,
                  rules,
                  options,
                  samples,
                  regions,
                  limits.jumper_mm,
                  corner_lift_of(limits, options),
                  started,
                  start,
                  end,
                  SearchPlan::of(room)};
  std::deque<Chain> chains;
  for (int k = 0; k < options.threads; ++k)
    chains.emplace_back(task, options.seed * 1000003 + static_cast<std::uint64_t>(k));
  Certifier certifier(original, copy, limits, options);
  search(task, certifier, chains, std::max(1, static_cast<int>(room / kModulesAChain)), progress);
  const LatticeMesh& best = *best_of(chains).best();
  LatticeMesh net = best;
  ModuleLayout refusals;
  count_refusals(task, net, refusals);
  std::vector<ModuleLayout> layouts{certifier.first(std::move(net))};
  layouts[0].refused = std::move(refusals.refused);
  if (options.front) certify_others(task, certifier, best, front_of(chains), layouts);
  return layouts;
}

ModuleLayout grow_lattice(const mesh::Surface& surface, const LayoutLimits& limits,
                          const SurfaceLatticeOptions& options, const ProgressSink& progress) {
  SurfaceLatticeOptions one = options;
  one.front = false;
  return std::move(grow_front(surface, limits, one, progress).front());
}

}  // namespace triskin::lattice
