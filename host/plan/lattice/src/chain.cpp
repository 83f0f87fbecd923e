// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace triskin::lattice {
namespace {

constexpr int kStepsAStart = 30;
constexpr double kStartsShare = 0.08;  // The starts together get at most this fraction of the time.
constexpr double kRaceHeat = 0.1;
// Each annealing has 40 steps per module, and there are at most 20 annealings.
constexpr int kStepsAModule = 40, kMaxRuns = 20;
constexpr double kCold = 0.05;         // A step may lose this many modules at the end of an annealing.
constexpr int kSmallIsland = 8;        // An island of up to 8 modules may be removed as a whole.
constexpr double kIslandShare = 0.15;  // This fraction of the steps removes a whole island, if the tries find one.
constexpr int kTriesForIsland = 9, kTriesForPlace = 8;
constexpr double kMargin_mm = 40.0;  // Islands grow within this distance of the removed part.

}  // namespace

// Measured (docs/measurements/lattice.md): in a small part few islands can be divided as the rounded price assumes, and
// its steps separate layouts from each other. In a large part steps are few, and are better spent on one layout than on
// a race; wide tries, and the hot start that goes with them, gain nothing there.
SearchPlan SearchPlan::of(double room_modules) {
  constexpr double kNever = 2.0;
  constexpr RelaxTries kWide{{35.0, 3}, {90.0, 6}, RelaxTry{160.0, 6}};
  SearchPlan small{
      .starts = 12, .race_share = 0.08, .first_share = 1.0, .rounded_from = 0.5, .hot = 1.0, .tries = kWide};
  if (room_modules < kRoundedModules) small.rounded_from = kNever;
  if (room_modules < kLargeModules) return small;
  return {.starts = 6, .race_share = 0.03, .first_share = 0.25, .rounded_from = 0.8, .hot = 0.6, .tries = {}};
}

Value GrowthTask::value(LatticeMesh& net, NetPrice& price, PlaceValue& module_value) const {
  if (net.size() == 0) return {};  // One module is better than none, although its controller costs more.
  return {module_value(net) + options.hinge_reward * net.joints(), price(net)};
}

double GrowthTask::fraction(int steps) const {
  if (options.iterations > 0) return std::min(1.0, static_cast<double>(steps) / options.iterations);
  return std::min(1.0, std::chrono::duration<double>(now() - start) / (end - start));
}

Chain::Chain(const GrowthTask& task, std::uint64_t seed)
    : task_(task),
      random_(seed),
      price_(task.options.price, task.jumper_mm),
      worth_(task.regions),
      grower_(task.surface, task.rules, task.samples, task.corner_lift_mm, task.end, task.options.now) {
  grower_.set_tries(task.plan.tries);
  confine({});
}

void Chain::build() {
  const int iterations = task_.options.iterations;
  const int most = iterations > 0 ? std::min(task_.plan.starts, 1 + iterations / kStepsAStart) : task_.plan.starts;
  std::vector<FoundLayout> starts;
  for (int k = 0; k < most; ++k) {
    if (k > 0 && iterations == 0 && task_.fraction(0) > kStartsShare) break;
    start_anew();
    starts.push_back({std::make_shared<const LatticeMesh>(now_), kept_value()});
  }
  const auto keep_best = [&starts](std::size_t count) {
    std::ranges::stable_sort(starts, std::greater{}, &FoundLayout::value);
    starts.erase(starts.begin() + static_cast<std::ptrdiff_t>(count), starts.end());
  };
  raced_from_ = task_.fraction(steps_);
  double until = raced_from_;
  for (std::size_t left = (starts.size() + 1) / 2; left > 1; left = (left + 1) / 2) {
    keep_best(left);
    for (FoundLayout& start : starts) improve(start, until += task_.plan.race_share / static_cast<double>(left));
  }
  keep_best(1);
  take(starts.front());
  race_heat_ = 0.0;
}

void Chain::run(int steps) {
  for (int k = 0; k < steps && !grower_.late(); ++k, ++steps_) step();
}

void Chain::adopt(const NetCopy& net) {
  set(*net);
  if (!is_best()) return;
  best_ = net;
  best_value_ = kept_value();
}

void Chain::work_in(const Zone& zone, const Chain& leader) {
  schedule_ = leader.schedule_;
  steps_ = leader.steps_;
  LatticeMesh net = leader.now_;
  pinned_ = pin_outside(net, zone);
  set(std::move(net));
  confine(zone);
}

void Chain::confine(const Zone& zone) {
  grower_.confine(zone);
  samples_.clear();
  for (int k = 0; k < static_cast<int>(task_.samples.size()); ++k) {
    if (zone.holds(task_.samples[at(k)].point)) samples_.push_back(k);
  }
}

void Chain::take_merged(LatticeMesh net) {
  pinned_.clear();
  confine({});
  if (grower_.remove_overrunning(net)) net.separate();
  set(std::move(net));
  if (would_be_kept()) keep();
}

void Chain::set(LatticeMesh net) {
  now_ = std::move(net);
  price_.forget();
  value_ = task_.value(now_, price_, worth_);
}

void Chain::start_anew() {
  LatticeMesh net = task_.started;
  if (net.size() > 0) grower_.grow(net, {}, random_);
  grower_.fill(net, {}, random_, static_cast<int>(task_.samples.size()) / 2);
  (void)grower_.remove_overrunning(net);
  net.separate();
  set(std::move(net));
}

void Chain::take(const FoundLayout& found) {
  best_ = found.net;
  set(*best_);
  best_value_ = kept_value();
}

void Chain::improve(FoundLayout& start, double until) {
  take(start);
  race_heat_ = kRaceHeat;
  while (task_.fraction(steps_) < until && !grower_.late()) run(1);
  start = {best_, best_value_};
}

// A small part takes few steps to anneal: it is annealed several times, each time from another start.
void Chain::plan_runs(int chains) {
  schedule_ = {task_.fraction(steps_), 1, 0};
  if (steps_ == 0 || best_->size() == 0 || schedule_.begun_at >= 1.0) return;
  const double left = 1.0 - schedule_.begun_at;
  const double steps_left = task_.options.iterations > 0
                                ? task_.options.iterations - steps_
                                : steps_ / std::max(1e-6, schedule_.begun_at - raced_from_) * left;
  schedule_.runs = std::clamp(static_cast<int>(chains * steps_left / (kStepsAModule * best_->size())), 1, kMaxRuns);
}

// Returns the number of annealings done, with the fraction of the current one.
double Chain::runs_done() const {
  const double left = 1.0 - schedule_.begun_at + 1e-9;
  return schedule_.runs * std::clamp((task_.fraction(steps_) - schedule_.begun_at) / left, 0.0, 1.0);
}

void Chain::begin_due_run() {
  const int run = std::min(static_cast<int>(runs_done()), schedule_.runs - 1);
  if (run == schedule_.run) return;
  schedule_.run = run;
  start_anew();
}

double Chain::heat() const {
  const double hot = task_.plan.hot;
  return race_heat_ > 0.0 ? race_heat_ : hot * std::pow(kCold / hot, fraction_);
}

// Returns the value that a step compares.
double Chain::searched(const Value& value) const {
  const SearchPlan& plan = task_.plan;
  if (fraction_ >= plan.rounded_from) return value.rounded();
  return value.relaxed(plan.first_share + (1.0 - plan.first_share) * fraction_ / plan.rounded_from);
}

void Chain::step() {
  if (race_heat_ == 0.0 && grower_.zone().sides.empty()) begin_due_run();
  fraction_ = race_heat_ > 0.0 ? 0.0 : std::clamp(runs_done() - schedule_.run, 0.0, 1.0);
  if (now_.size() == 0) return grower_.fill(now_, {}, random_, 10);
  if (samples_.empty()) return;  // The zone is almost empty.
  now_.begin();
  const Value value = ruin_and_recreate();
  if (grower_.late() || searched(value) < searched(value_) + heat() * std::log(std::max(1e-12, random_.unit())))
    return now_.roll_back();
  now_.commit();
  value_ = value;
  keep_if_worth_it();
}

void Chain::keep_if_worth_it() {
  if (!would_be_kept()) return;
  if (grower_.remove_overrunning(now_)) {
    now_.separate();
    value_ = task_.value(now_, price_, worth_);
    if (!would_be_kept()) return;
  }
  keep();
}

Value Chain::ruin_and_recreate() {
  const Grower::Ball ball = ruin();
  now_.separate();
  const Grower::Ball around{ball.center, ball.radius_mm + kMargin_mm};
  if (random_.unit() < 0.25) grower_.fill(now_, around, random_, 3);
  grower_.grow(now_, around, random_);
  grower_.fill(now_, around, random_, 4);
  now_.separate();
  return task_.value(now_, price_, worth_);
}

// Keeps the best of all, and the best for each number of modules near it.
void Chain::keep() {
  auto net = std::make_shared<LatticeMesh>(now_);
  unpin(*net, pinned_);
  const NetCopy copy = std::move(net);
  front_.keep(copy, kept_value());
  if (!is_best()) return;
  best_ = copy;
  best_value_ = kept_value();
  front_.forget_below(best_->size() - 2 * kFront);
}

const Sample& Chain::some_sample() {
  return task_.samples[at(samples_[at(random_.scaled_below(static_cast<int>(samples_.size())))])];
}

// Picks a place around uncovered surface if one is found quickly, else any; places that must be covered come first.
Vec3 Chain::place_to_ruin() {
  const auto& must_cover = task_.regions.must_cover();
  for (int k = 0; k < 2 && !must_cover.empty(); ++k) {
    const auto& place = must_cover[at(random_.scaled_below(static_cast<int>(must_cover.size())))];
    if (grower_.zone().holds(place.point_mm) && !PlaceValue::covered(now_, place)) return place.point_mm;
  }
  Vec3 place = some_sample().point;
  for (int k = 1; k < kTriesForPlace && grower_.covered(now_, place); ++k) place = some_sample().point;
  return place;
}

Grower::Ball Chain::ruin() {
  if (random_.unit() < kIslandShare) {
    if (const auto ball = ruin_island()) return *ball;
  }
  const Grower::Ball ball{place_to_ruin(), 20.0 + 45.0 * random_.unit() * random_.unit()};
  std::vector<int> inside;
  now_.near(ball.center, ball.radius_mm, inside);
  for (const int t : inside) {
    if (!now_.triangles()[at(t)].is_fixed) now_.remove_triangle(t);
  }
  return ball;
}

// Returns a module of a small island if a few tries find one.
std::optional<int> Chain::some_triangle_of_small_island() {
  std::optional<int> found;
  const auto is_in_small_island = [&](int t) {
    return now_.island_sizes()[at(now_.triangles()[at(t)].island)] <= kSmallIsland;
  };
  for (int k = 0; k < kTriesForIsland && !found; ++k) {
    const Vec3 place = some_sample().point;
    (void)now_.any_near(place, kModuleReach_mm, [&](int t) {
      if (lies_over(now_.triangles()[at(t)], place) && is_in_small_island(t)) found = t;
      return found.has_value();
    });
  }
  return found;
}

// Removes a small island as a whole; the modules around it may then close the gap.
std::optional<Grower::Ball> Chain::ruin_island() {
  const std::optional<int> first = some_triangle_of_small_island();
  if (!first) return std::nullopt;
  std::vector<int> members{*first};
  for (std::size_t k = 0; k < members.size(); ++k) {
    if (now_.triangles()[at(members[k])].is_fixed) return std::nullopt;
    for (int s = 0; s < 3; ++s) {
      const int n = now_.neighbour(members[k], s);
      if (n >= 0 && std::ranges::find(members, n) == members.end()) members.push_back(n);
    }
  }
  std::ranges::sort(members);
  Grower::Ball ball{Vec3::Zero(), 25.0};
  for (const int t : members) ball.center += now_.center(t) / static_cast<double>(members.size());
  for (const int t : members) {
    ball.radius_mm = std::max(ball.radius_mm, (now_.center(t) - ball.center).norm());
    now_.remove_triangle(t);
  }
  return ball;
}

}  // namespace triskin::lattice
