// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/scene_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <set>

#include "triskin/base/error.hpp"
#include "triskin/scenario/running_skin.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::scenario {
namespace {

using scene::Expectation;
using Kind = Expectation::Kind;
using Changes = std::array<double, layout::kTaxelsPerModule>;

// An instant is observed by the next sample of each module, which arrives within this time.
constexpr std::uint64_t kInstant_us = 300'000;

struct ModuleReport {
  Changes changes{};
  wire::ModuleState state = wire::ModuleState::kUnknown;
  bool heard = false;
};

bool is_force(Kind kind) {
  return kind == Kind::kForceAbove || kind == Kind::kForceBelow;
}

// Follows one expectation through the samples.
class Watch {
 public:
  Watch(const Expectation& expectation, double corner_cut_mm)
      : expectation_(expectation), corner_cut_mm_(corner_cut_mm) {}
  [[nodiscard]] std::uint64_t end_us() const {
    return expectation_.until_us.value_or(expectation_.from_us + kInstant_us);
  }

  void take(int module, std::uint64_t at_us, const std::vector<ModuleReport>& reports) {
    if (at_us < expectation_.from_us || at_us >= end_us()) return;
    if (expectation_.module >= 0 && module != expectation_.module) return;
    if (!begun_) await(reports);
    awaited_.erase(module);
    // A value of the whole skin is complete when each of its modules has reported once.
    if (!awaited_.empty() || (!expectation_.until_us && samples_ > 0)) return;
    ++samples_;
    note(at_us, reports);
  }

  [[nodiscard]] ExpectationResult result() const {
    const bool held = expectation_.kind == Kind::kSilent ? samples_ == 0
                                                         : samples_ > 0 && (expectation_.once ? any_held_ : all_held_);
    return {expectation_, held, samples_, seen(held)};
  }

 private:
  // A module that has never reported may not be connected, so it is not awaited.
  void await(const std::vector<ModuleReport>& reports) {
    begun_ = true;
    for (std::size_t m = 0; m < reports.size() && expectation_.module < 0; ++m) {
      if (reports[m].heard) awaited_.insert(static_cast<int>(m));
    }
  }
  [[nodiscard]] double value_of(const ModuleReport& report) const {
    if (is_force(expectation_.kind)) return force_n(report.changes, corner_cut_mm_, expectation_.taxel);
    if (expectation_.taxel >= 0) return report.changes[static_cast<std::size_t>(expectation_.taxel)];
    return std::ranges::max(report.changes);
  }
  [[nodiscard]] double value_of(const std::vector<ModuleReport>& reports) const {
    if (expectation_.module >= 0) return value_of(reports[static_cast<std::size_t>(expectation_.module)]);
    double value = 0.0;
    for (const ModuleReport& r : reports)
      value = is_force(expectation_.kind) ? value + value_of(r) : std::max(value, value_of(r));
    return value;
  }
  [[nodiscard]] bool holds(double value, wire::ModuleState state) const {
    switch (expectation_.kind) {
      case Kind::kForceAbove:
      case Kind::kCountsAbove:
        return value > expectation_.bound;
      case Kind::kForceBelow:
      case Kind::kCountsBelow:
        return value < expectation_.bound;
      case Kind::kPressed:
        return value >= device::TouchMap::kPressed_counts;
      case Kind::kNotPressed:
        return value < device::TouchMap::kPressed_counts;
      case Kind::kState:
        return state == expectation_.state;
      case Kind::kSilent:
        return false;
    }
    return false;
  }
  void note(std::uint64_t at_us, const std::vector<ModuleReport>& reports) {
    const double value = value_of(reports);
    const auto state = reports[static_cast<std::size_t>(std::max(0, expectation_.module))].state;
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
    const bool held = holds(value, state);
    if (states_.insert(state).second) state_names_ += (state_names_.empty() ? "" : ", ") + name_of(state);
    if (all_held_ && !held) first_failure_us_ = at_us;
    all_held_ = all_held_ && held;
    any_held_ = any_held_ || held;
  }
  static std::string name_of(wire::ModuleState state) { return std::string(scene::kModuleStateNames.name(state)); }

  [[nodiscard]] std::string seen(bool held) const {
    if (samples_ == 0)
      return awaited_.empty() ? "no sample came" : fmt::format("no sample came of {} modules", awaited_.size());
    const std::string number = samples_ == 1 ? "1 sample" : fmt::format("{} samples", samples_);
    if (expectation_.kind == Kind::kSilent) return number + " came";
    const std::string when =
        held ? "" : fmt::format(", not as expected from {:g} s on", static_cast<double>(first_failure_us_) * 1e-6);
    if (expectation_.kind == Kind::kState) return fmt::format("{}: {}{}", number, state_names_, when);
    const char* unit = is_force(expectation_.kind) ? "N" : "counts";
    if (max_ - min_ < 5e-4) return fmt::format("{}: {:.4g} {}{}", number, max_, unit, when);
    return fmt::format("{}: {:.4g} … {:.4g} {}{}", number, min_, max_, unit, when);
  }

  Expectation expectation_;
  double corner_cut_mm_;
  bool begun_ = false;
  std::set<int> awaited_;  // These modules have not reported since the beginning.
  std::size_t samples_ = 0;
  double min_ = std::numeric_limits<double>::infinity(), max_ = -std::numeric_limits<double>::infinity();
  bool all_held_ = true, any_held_ = false;
  std::uint64_t first_failure_us_ = 0;
  std::set<wire::ModuleState> states_;
  std::string state_names_;
};

}  // namespace

std::size_t SceneCheck::failed() const {
  return static_cast<std::size_t>(std::ranges::count(results, false, &ExpectationResult::held));
}

SceneCheck check_scene(scene::Scene scene, const ProgressSink& progress) {
  if (scene.expectations.empty())
    throw InputError(
        "the scene expects nothing; say what the skin should report with \"expect\" (docs/scene_check.md)");
  std::vector<ModuleReport> reports(scene.design.layout.modules.size());
  std::deque<Watch> watches;
  std::uint64_t end_us = 0;
  for (const Expectation& e : scene.expectations) {
    watches.emplace_back(e, scene.design.layout.corner_cut_mm);
    end_us = std::max(end_us, watches.back().end_us());
  }
  const design::RestValues* rest = nullptr;
  RunningSkin skin(std::move(scene),
                   [&](const device::ModuleSample& s) {
                     if (rest == nullptr) return;  // The sample arrived while the stream was being opened.
                     reports[static_cast<std::size_t>(s.module)] = {changes_of(s, *rest), s.sample.state, true};
                     for (Watch& w : watches) w.take(s.module, s.sampled.link_us, reports);
                   },
                   {});
  rest = &skin.rest();
  constexpr std::uint64_t kStep_us = 250'000;
  while (skin.now_us() < end_us + kStep_us) {
    skin.run_until(std::min(end_us + kStep_us, skin.now_us() + kStep_us));
    report(progress, "simulating", static_cast<double>(skin.now_us()) / static_cast<double>(end_us + kStep_us));
  }
  SceneCheck check;
  check.simulated_s = static_cast<double>(skin.now_us()) * 1e-6;
  for (const Watch& w : watches) check.results.push_back(w.result());
  return check;
}

}  // namespace triskin::scenario
