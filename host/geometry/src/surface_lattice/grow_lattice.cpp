// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "canonical.hpp"
#include "certify.hpp"
#include "grower.hpp"
#include "kept_modules.hpp"
#include "layout_front.hpp"
#include "net_price.hpp"
#include "place_value.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/geometry/map_modules.hpp"
#include "triskin/geometry/surface_lattice.hpp"
#include "triskin/host/error.hpp"
#include "triskin/host/parallel.hpp"

namespace triskin::geometry {
namespace {

using namespace surface_lattice;
using Clock = Grower::Clock;

constexpr int kStepsARound = 32;      // of each chain, between reports
constexpr int kRoundsAnExchange = 4;  // of the best layout
constexpr int kStarts = 12, kStepsAStart = 30;
constexpr double kStartsShare = 0.08, kRaceShare = 0.08;  // of the time: all starts, each round between the better ones
constexpr double kRaceHeat = 0.1;
constexpr int kStepsAModule = 40, kMostRuns = 20;  // of one annealing
constexpr double kHot = 0.6, kCold = 0.05;         // modules a step may lose, at the start and at the end
// Whole controllers count from this part of an annealing on, where the area has room for as many modules. In fewer the
// steps of the price part layouts from each other, and few islands can be divided as the rounded price hopes.
constexpr double kRoundedFrom = 0.5, kRoundedModules = 48.0;
constexpr int kSmallIsland = 8;        // modules: such an island may go as a whole
constexpr double kIslandShare = 0.15;  // of the steps in which one goes, where tries find one
constexpr int kTriesForIsland = 9;
constexpr int kFront = 12;            // of the layouts that are kept beside the best
constexpr std::size_t kMore = 8;      // with as many modules as others of them
constexpr double kFrontShare = 0.05;  // of the time, beyond its end: to certify them
constexpr double kSampleArea_mm2 = 50.0;
constexpr double kLiftShare =
    0.7;  // of the limit, for corners of the net: those of the rigid module stand off a little more
constexpr double kNothing = -1e300;  // value of no layout

Clock::time_point now_of(const SurfaceLatticeOptions& options) {
  return options.now ? options.now() : Clock::now();
}

// Of a layout, by either price.
struct Value {
  double relaxed = kNothing, rounded = kNothing;
};

struct GrowthTask {
  const Surface& surface;
  const Rules& rules;
  const SurfaceLatticeOptions& options;
  const std::vector<Sample>& samples;
  const CopiedRegions& regions;
  double jumper_mm, corner_lift_mm;
  const LatticeNet& begun;  // the modules that are kept, or none
  Clock::time_point start, end;
  double Value::* kept_by;  // what decides which layouts are kept, and the last part of an annealing

  [[nodiscard]] Value value(LatticeNet& net, NetPrice& price, PlaceValue& worth) const {
    if (net.size() == 0) return {};  // one module is better, although its controller costs more
    const double gain = worth(net) + options.hinge_reward * net.joints();
    const EstimatedPrice estimated = price(net);
    return {gain - estimated.relaxed, gain - estimated.rounded};
  }
  [[nodiscard]] double fraction(int steps) const {
    if (options.iterations > 0) return std::min(1.0, static_cast<double>(steps) / options.iterations);
    return std::min(1.0, std::chrono::duration<double>(now_of(options) - start) / (end - start));
  }
};

// One annealed sequence of ruin and recreate.
class Chain {
 public:
  Chain(const GrowthTask& task, std::uint64_t seed)
      : task_(task),
        random_(seed),
        price_(task.options.price, task.jumper_mm),
        worth_(task.regions),
        grower_(task.surface, task.rules, task.samples, task.corner_lift_mm, task.end, task.options.now) {}

  // Makes complete layouts from several starts: place and turn of the first module decide more than later steps mend.
  // The better half is improved for a while, and again its better half, until one is left.
  void build() {
    const int iterations = task_.options.iterations;
    const int most = iterations > 0 ? std::min(kStarts, 1 + iterations / kStepsAStart) : kStarts;
    std::vector<FoundLayout> starts;
    for (int k = 0; k < most; ++k) {
      if (k > 0 && iterations == 0 && task_.fraction(0) > kStartsShare) break;
      start_anew();
      starts.push_back({std::make_shared<const LatticeNet>(now_), kept_value()});
    }
    const double before = task_.fraction(steps_);
    double until = before;
    for (std::size_t left = (starts.size() + 1) / 2; left > 1; left = (left + 1) / 2) {
      keep_best(starts, left);
      for (std::size_t k = 0; k < left; ++k) improve(starts[k], until += kRaceShare / static_cast<double>(left));
    }
    keep_best(starts, 1);
    take(starts.front());
    heat_ = 0.0;
    plan_runs(task_.fraction(steps_) - before);
  }

  void run(int steps) {
    for (int k = 0; k < steps && !grower_.late(); ++k, ++steps_) step();
  }

  void adopt(const NetCopy& net) {
    set(*net);
    if (kept_value() > best_value_) {
      best_ = net;
      best_value_ = kept_value();
    }
  }

  [[nodiscard]] const NetCopy& best() const { return best_; }
  [[nodiscard]] double best_value() const { return best_value_; }
  [[nodiscard]] const LayoutFront& front() const { return front_; }
  [[nodiscard]] int steps() const { return steps_; }
  /// In the last of its annealings: what others found may be taken over.
  [[nodiscard]] bool in_last_run() const { return run_ == runs_ - 1; }

 private:
  void set(LatticeNet net) {
    now_ = std::move(net);
    price_.forget();
    value_ = task_.value(now_, price_, worth_);
  }

  void start_anew() {
    LatticeNet net = task_.begun;
    if (net.size() > 0) grower_.grow(net, {}, random_);
    grower_.fill(net, {}, random_, static_cast<int>(task_.samples.size()) / 2);
    (void)grower_.remove_overrunning(net);
    net.separate();
    set(std::move(net));
  }

  void take(const FoundLayout& found) {
    best_ = found.net;
    set(*best_);
    best_value_ = kept_value();
  }

  static void keep_best(std::vector<FoundLayout>& starts, std::size_t count) {
    std::ranges::stable_sort(starts, std::greater{}, &FoundLayout::value);
    starts.erase(starts.begin() + static_cast<std::ptrdiff_t>(count), starts.end());
  }

  void improve(FoundLayout& start, double until) {
    take(start);
    heat_ = kRaceHeat;
    while (task_.fraction(steps_) < until && !grower_.late()) run(1);
    start = {best_, best_value_};
  }

  // A small part takes few steps to anneal: it is annealed several times, each time from another start.
  void plan_runs(double fraction_raced) {
    begun_at_ = task_.fraction(steps_);
    if (steps_ == 0 || best_->size() == 0 || begun_at_ >= 1.0) return;
    const double steps_left = task_.options.iterations > 0
                                  ? task_.options.iterations - steps_
                                  : steps_ / std::max(1e-6, fraction_raced) * (1.0 - begun_at_);
    runs_ = std::clamp(static_cast<int>(steps_left / (kStepsAModule * best_->size())), 1, kMostRuns);
  }

  // Progress of the current run, 0 … 1; begins the next run when it is due.
  double fraction_of_run() {
    const double runs = runs_ * std::clamp((task_.fraction(steps_) - begun_at_) / (1.0 - begun_at_ + 1e-9), 0.0, 1.0);
    const int run = std::min(static_cast<int>(runs), runs_ - 1);
    if (run != run_) {
      run_ = run;
      start_anew();
    }
    return runs - run;
  }

  void step() {
    const double fraction = heat_ > 0.0 ? 0.0 : fraction_of_run();
    const double heat = heat_ > 0.0 ? heat_ : kHot * std::pow(kCold / kHot, fraction);
    const auto by = fraction < kRoundedFrom ? &Value::relaxed : task_.kept_by;
    if (now_.size() == 0) return grower_.fill(now_, {}, random_, 10);
    now_.begin();
    const Value value = ruin_and_recreate();
    if (grower_.late() || value.*by < value_.*by + heat * std::log(std::max(1e-12, random_.unit())))
      return now_.roll_back();
    now_.commit();
    value_ = value;
    if (!would_be_kept()) return;
    if (grower_.remove_overrunning(now_)) {
      now_.separate();
      value_ = task_.value(now_, price_, worth_);
      if (!would_be_kept()) return;
    }
    keep();
  }

  Value ruin_and_recreate() {
    const Grower::Ball ball = ruin(now_);
    now_.separate();
    const Grower::Ball around{ball.center, ball.radius_mm + 40.0};
    if (random_.unit() < 0.25) grower_.fill(now_, around, random_, 3);
    grower_.grow(now_, around, random_);
    grower_.fill(now_, around, random_, 4);
    now_.separate();
    return task_.value(now_, price_, worth_);
  }

  [[nodiscard]] double kept_value() const { return value_.*task_.kept_by; }
  [[nodiscard]] bool is_best() const { return kept_value() > best_value_ + 1e-9; }
  [[nodiscard]] bool would_be_kept() const { return is_best() || front_.would_keep(now_, kept_value()); }

  // The best of all, and the best of each number of modules near it.
  void keep() {
    const auto copy = std::make_shared<const LatticeNet>(now_);
    front_.keep(copy, kept_value());
    if (!is_best()) return;
    best_ = copy;
    best_value_ = kept_value();
    front_.forget_below(best_->size() - 2 * kFront);
  }

  // Around an uncovered place when one is found quickly, else around any module; what must be covered first.
  [[nodiscard]] Vec3 place_to_ruin(const LatticeNet& net) {
    const auto& must_cover = task_.regions.must_cover();
    for (int k = 0; k < 2 && !must_cover.empty(); ++k) {
      const auto& place = must_cover[at(random_.scaled_below(static_cast<int>(must_cover.size())))];
      if (!PlaceValue::covered(net, place)) return place.point_mm;
    }
    for (int k = 0; k < 8 && !task_.samples.empty(); ++k) {
      const Sample& s = task_.samples[at(random_.scaled_below(static_cast<int>(task_.samples.size())))];
      if (!grower_.covered(net, s.point)) return s.point;
    }
    return net.triangles()[at(some_triangle(net))].center;
  }

  [[nodiscard]] int some_triangle(const LatticeNet& net) {
    for (;;) {
      const int t = random_.scaled_below(static_cast<int>(net.triangles().size()));
      if (net.used(t)) return t;
    }
  }

  Grower::Ball ruin(LatticeNet& net) {
    if (random_.unit() < kIslandShare) {
      if (const auto ball = ruin_island(net)) return *ball;
    }
    const Grower::Ball ball{place_to_ruin(net), 20.0 + 45.0 * random_.unit() * random_.unit()};
    std::vector<int> inside;
    net.near(ball.center, ball.radius_mm, inside);
    for (const int t : inside) {
      if (!net.triangles()[at(t)].is_fixed) net.remove_triangle(t);
    }
    return ball;
  }

  // A module of a small island, when a few tries find one.
  [[nodiscard]] std::optional<int> some_triangle_of_small_island(const LatticeNet& net) {
    for (int k = 0; k < kTriesForIsland; ++k) {
      const int t = some_triangle(net);
      if (net.island_sizes()[at(net.triangles()[at(t)].island)] <= kSmallIsland) return t;
    }
    return std::nullopt;
  }

  // A small island goes as a whole; what stood round it may then close the gap.
  std::optional<Grower::Ball> ruin_island(LatticeNet& net) {
    const std::optional<int> first = some_triangle_of_small_island(net);
    if (!first) return std::nullopt;
    std::vector<int> members{*first};
    for (std::size_t k = 0; k < members.size(); ++k) {
      if (net.triangles()[at(members[k])].is_fixed) return std::nullopt;
      for (int s = 0; s < 3; ++s) {
        const int n = net.neighbour(members[k], s);
        if (n >= 0 && std::ranges::find(members, n) == members.end()) members.push_back(n);
      }
    }
    std::ranges::sort(members);
    Grower::Ball ball{Vec3::Zero(), 25.0};
    for (const int t : members) ball.center += net.triangles()[at(t)].center / static_cast<double>(members.size());
    for (const int t : members) {
      ball.radius_mm = std::max(ball.radius_mm, (net.triangles()[at(t)].center - ball.center).norm());
      net.remove_triangle(t);
    }
    return ball;
  }

  const GrowthTask& task_;
  Dice random_;
  NetPrice price_;
  PlaceValue worth_;
  Grower grower_;
  LatticeNet now_;  // what price_ knows
  NetCopy best_;
  LayoutFront front_;
  Value value_;
  double best_value_ = kNothing;
  double heat_ = 0.0;  // > 0: instead of the schedule
  double begun_at_ = 0.0;
  int runs_ = 1, run_ = 0;
  int steps_ = 0;
};

void each(std::deque<Chain>& chains, const auto& work) {
  in_parallel(static_cast<int>(chains.size()), chains.size(), [&](std::size_t k) { work(chains[k]); });
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
  if (!(o.corner_cut_mm >= 0.0 && o.corner_cut_mm <= design::kMostCornerCut_mm))
    throw InputError(fmt::format("lattice: the corner cut must be 0 … {} mm", design::kMostCornerCut_mm));
  if (!(o.corner_lift_mm >= 0.0)) throw InputError("lattice: the corner lift must not be negative");
  for (const double v : {l.edge_error_mm, l.hinge_gap_mm, l.center_gap_mm, l.fold_rad, l.penetration_mm, l.overrun_mm,
                         l.lift_mm, l.depth_mm}) {
    if (!(v > 0.0)) throw InputError("lattice: every limit must be positive");
  }
}

const Chain& best_of(const std::deque<Chain>& chains) {
  return *std::ranges::max_element(chains,
                                   [](const Chain& a, const Chain& b) { return a.best_value() < b.best_value(); });
}

// The best of all chains for each number of modules, most modules first, then the most valuable of the others, with as
// many modules on more or fewer islands; not the best of all, which is kept anyway.
std::vector<const LatticeNet*> front_of(const std::deque<Chain>& chains) {
  std::map<std::pair<int, int>, const FoundLayout*, std::greater<>> found;
  for (const Chain& chain : chains) {
    for (const auto& [numbers, of_chain] : chain.front().found()) {
      const FoundLayout*& best = found[numbers];
      if (best == nullptr || of_chain.value > best->value) best = &of_chain;
    }
  }
  const LatticeNet* const best = best_of(chains).best().get();
  std::vector<const FoundLayout*> by_value;
  for (const auto& [numbers, of_numbers] : found) {
    if (numbers.first >= best->size() - kFront && of_numbers->net.get() != best) by_value.push_back(of_numbers);
  }
  std::ranges::stable_sort(by_value, std::greater{}, &FoundLayout::value);
  std::map<int, const LatticeNet*, std::greater<>> by_size;
  std::vector<const LatticeNet*> more;
  for (const FoundLayout* f : by_value) {
    const LatticeNet* const net = f->net.get();
    const bool is_first = net->size() != best->size() && by_size.try_emplace(net->size(), net).second;
    if (!is_first && more.size() < kMore) more.push_back(net);
  }
  std::vector<const LatticeNet*> nets;
  for (const auto& [size, net] : by_size) nets.push_back(net);
  nets.insert(nets.end(), more.begin(), more.end());
  return nets;
}

// Counts, for the report, the limits that refuse further modules; a module that fits after all is kept.
void count_refusals(const GrowthTask& task, LatticeNet& net, ModuleLayout& layout) {
  Dice random(task.options.seed);
  Grower grower(task.surface, task.rules, task.samples, task.corner_lift_mm, Clock::time_point::max());
  grower.grow(net, {}, random);
  for (std::size_t k = 1; k < kRefusals; ++k) {
    if (grower.refused[k] > 0) layout.refused.emplace_back(name_of(static_cast<Refusal>(k)), grower.refused[k]);
  }
}

}  // namespace

double corner_lift_of(const LayoutLimits& limits, const SurfaceLatticeOptions& options) {
  return std::min(options.corner_lift_mm, kLiftShare * limits.lift_mm);
}

std::vector<ModuleLayout> grow_front(const Surface& original, const LayoutLimits& limits,
                                     const SurfaceLatticeOptions& options, const ProgressSink& progress) {
  check_options(limits, options);
  const auto start = now_of(options);
  const CanonicalCopy copy(options.solver == nullptr ? original.mesh() : options.solver->mesh);
  const Surface surface(copy.mesh());
  const auto end =
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.time_limit_s));
  const CopiedRegions regions(options.regions, copy);
  const LayoutLimits searched = options.solver == nullptr ? limits : limits_on(*options.solver, limits);
  const Rules rules(surface, searched, regions.free_points());
  const std::vector<Sample> samples = spread_samples(surface, kSampleArea_mm2, options.seed);
  const LatticeNet begun = net_of_kept(surface, copy, options.kept, options.corner_cut_mm);
  const auto kept_by = surface.area_mm2() < kRoundedModules * kModuleArea_mm2 ? &Value::relaxed : &Value::rounded;
  const GrowthTask task{surface, rules, options, samples, regions, limits.jumper_mm, corner_lift_of(limits, options),
                        begun,   start, end,     kept_by};
  std::deque<Chain> chains;
  for (int k = 0; k < options.threads; ++k)
    chains.emplace_back(task, options.seed * 1000003 + static_cast<std::uint64_t>(k));
  each(chains, [](Chain& c) { c.build(); });
  for (int round = 1; now_of(options) < end && !interrupt_request() &&
                      (options.iterations == 0 || chains[0].steps() < options.iterations);
       ++round) {
    const int steps =
        options.iterations == 0 ? kStepsARound : std::min(kStepsARound, options.iterations - chains[0].steps());
    each(chains, [steps](Chain& c) { c.run(steps); });
    const Chain& best = best_of(chains);
    report(progress, "lattice", task.fraction(chains[0].steps()),
           fmt::format("{} modules in {} islands", best.best()->size(), best.best()->islands()));
    if (round % kRoundsAnExchange != 0) continue;
    for (Chain& c : chains) {
      if (&c != &best && c.in_last_run() && c.best_value() < best.best_value() - 0.5) c.adopt(best.best());
    }
  }
  LatticeNet net = *best_of(chains).best();
  ModuleLayout refusals;
  count_refusals(task, net, refusals);
  Certifier certifier(original, copy, limits, options);
  std::vector<ModuleLayout> layouts{certifier.first(std::move(net))};
  layouts[0].refused = std::move(refusals.refused);
  if (!options.front) return layouts;
  const std::vector<const LatticeNet*> others = front_of(chains);
  std::vector<std::optional<ModuleLayout>> front(others.size());
  const auto front_end = end + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(kFrontShare * options.time_limit_s));
  in_parallel(options.threads, others.size(), [&](std::size_t k) {
    if (options.iterations > 0 || now_of(options) < front_end) front[k] = certifier.other(*others[k]);
  });
  for (std::optional<ModuleLayout>& layout : front) {
    if (layout) layouts.push_back(std::move(*layout));
  }
  return layouts;
}

ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits, const SurfaceLatticeOptions& options,
                          const ProgressSink& progress) {
  SurfaceLatticeOptions one = options;
  one.front = false;
  return std::move(grow_front(surface, limits, one, progress).front());
}

}  // namespace triskin::geometry
