// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scenario/scene_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "triskin/base/error.hpp"
#include "triskin/scenario/running_skin.hpp"
#include "triskin/skin/touch_map.hpp"

namespace triskin::scenario {
namespace {

using hardware::Expectation;
using Kind = Expectation::Kind;
using Changes = std::array<double, layout::kTaxelsPerModule>;

// An instant is observed by the next sample of each module, which arrives within this time.
constexpr std::uint64_t kInstant_us = 300'000;

struct ModuleReport {
  Changes changes{};
  wire::ModuleState state = wire::ModuleState::kUnknown;
  bool heard = false;
  double corner_cut_mm = 0.0;
};

// Modules of all parts have consecutive numbers here.
struct ModuleRange {
  std::size_t first = 0, count = 0;
  [[nodiscard]] bool has(std::size_t module) const { return module >= first && module < first + count; }
};

bool is_force(Kind kind) {
  return kind == Kind::kForceAbove || kind == Kind::kForceBelow;
}

// Follows one expectation through the samples.
class Watch {
 public:
  Watch(const Expectation& expectation, ModuleRange modules) : expectation_(expectation), modules_(modules) {}
  [[nodiscard]] std::uint64_t end_us() const {
    return expectation_.until_us.value_or(expectation_.from_us + kInstant_us);
  }

  void take(std::size_t module, std::uint64_t at_us, const std::vector<ModuleReport>& reports) {
    if (at_us < expectation_.from_us || at_us >= end_us() || !modules_.has(module)) return;
    if (!begun_) await(reports);
    awaited_.erase(module);
    // A value of the whole skin is complete when each of its modules has reported once.
    if (!awaited_.empty() || (!expectation_.until_us && samples_ > 0)) return;
    ++samples_;
    note(at_us, std::span(reports).subspan(modules_.first, modules_.count));
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
    for (std::size_t m = modules_.first; m < modules_.first + modules_.count; ++m) {
      if (reports[m].heard) awaited_.insert(m);
    }
  }
  [[nodiscard]] double value_of(const ModuleReport& report) const {
    if (is_force(expectation_.kind)) return force_n(report.changes, report.corner_cut_mm, expectation_.taxel);
    if (expectation_.taxel >= 0) return report.changes[static_cast<std::size_t>(expectation_.taxel)];
    return std::ranges::max(report.changes);
  }
  [[nodiscard]] double value_of(std::span<const ModuleReport> reports) const {
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
        return value >= skin::TouchMap::kPressed_counts;
      case Kind::kNotPressed:
        return value < skin::TouchMap::kPressed_counts;
      case Kind::kState:
        return state == expectation_.state;
      case Kind::kSilent:
        return false;
    }
    return false;
  }
  void note(std::uint64_t at_us, std::span<const ModuleReport> reports) {
    const double value = value_of(reports);
    const auto state = reports.front().state;
    min_ = std::min(min_, value);
    max_ = std::max(max_, value);
    const bool held = holds(value, state);
    if (states_.insert(state).second) state_names_ += (state_names_.empty() ? "" : ", ") + name_of(state);
    if (all_held_ && !held) first_failure_us_ = at_us;
    all_held_ = all_held_ && held;
    any_held_ = any_held_ || held;
  }
  static std::string name_of(wire::ModuleState state) { return std::string(hardware::kModuleStateNames.name(state)); }

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
  ModuleRange modules_;
  bool begun_ = false;
  std::set<std::size_t> awaited_;  // These modules have not reported since the beginning.
  std::size_t samples_ = 0;
  double min_ = std::numeric_limits<double>::infinity(), max_ = -std::numeric_limits<double>::infinity();
  bool all_held_ = true, any_held_ = false;
  std::uint64_t first_failure_us_ = 0;
  std::set<wire::ModuleState> states_;
  std::string state_names_;
};

constexpr std::uint64_t kStep_us = 250'000;

struct BusSample {
  std::size_t bus = 0, module = 0;  // The module is numbered in the joint scene of its bus.
  std::uint64_t arrived_us = 0, sampled_us = 0;
  Changes changes{};
  wire::ModuleState state = wire::ModuleState::kUnknown;
};

// Runs a bus and collects its samples.
class WatchedBus {
 public:
  WatchedBus(hardware::Scene scene, std::size_t bus)
      : bus_(bus), skin_(std::move(scene), [this](const session::ModuleSample& s) { take(s); }, {}) {
    is_open_ = true;
  }
  void run_until(std::uint64_t until_us, std::vector<BusSample>& arrived) {
    if (skin_.now_us() < until_us) skin_.run_until(until_us);
    arrived.insert(arrived.end(), samples_.begin(), samples_.end());
    samples_.clear();
  }
  [[nodiscard]] double now_s() const { return static_cast<double>(skin_.now_us()) * 1e-6; }

 private:
  void take(const session::ModuleSample& s) {
    if (!is_open_) return;  // The sample arrived while the stream was being opened.
    samples_.push_back({bus_, static_cast<std::size_t>(s.module), skin_.now_us(), s.sampled.link_us,
                        changes_of(s, skin_.rest()), s.sample.state});
  }

  std::size_t bus_;
  bool is_open_ = false;
  std::vector<BusSample> samples_;
  RunningSkin skin_;
};

// Numbers the modules of all parts on all buses. A part that is on several buses has its modules once.
class SkinReports {
 public:
  explicit SkinReports(const std::vector<hardware::JointScene>& buses) {
    for (const hardware::JointScene& bus : buses) {
      std::vector<std::size_t>& numbers = numbers_.emplace_back();
      const std::size_t modules = bus.scene.design.layout.modules.size();
      for (std::size_t c = 0; c < bus.names.size(); ++c) {
        const auto first = static_cast<std::size_t>(bus.offsets[c].module);
        const std::size_t end =
            c + 1 < bus.names.size() ? static_cast<std::size_t>(bus.offsets[c + 1].module) : modules;
        const ModuleRange range = add(bus.names[c], end - first, bus.scene.design.layout.corner_cut_mm);
        for (std::size_t m = 0; m < range.count; ++m) numbers.push_back(range.first + m);
      }
    }
  }
  [[nodiscard]] ModuleRange modules_of(const Expectation& e) const {
    if (parts_.size() > 1 && e.part.empty()) return {0, reports_.size()};
    const auto found = e.part.empty() ? parts_.begin() : parts_.find(e.part);
    if (found == parts_.end())
      throw InputError(fmt::format("{}: no bus has the part {}; leave the expectation out", e.place, e.part));
    if (e.module < 0) return found->second;
    return {found->second.first + static_cast<std::size_t>(e.module), 1};
  }
  // Notes what a module reports and returns its number.
  std::size_t take(const BusSample& s) {
    const std::size_t module = numbers_[s.bus][s.module];
    reports_[module].changes = s.changes;
    reports_[module].state = s.state;
    reports_[module].heard = true;
    return module;
  }
  [[nodiscard]] const std::vector<ModuleReport>& reports() const { return reports_; }

 private:
  ModuleRange add(const std::string& part, std::size_t modules, double corner_cut_mm) {
    const auto [known, is_new] = parts_.try_emplace(part, ModuleRange{reports_.size(), modules});
    if (is_new) {
      ModuleReport silent;
      silent.corner_cut_mm = corner_cut_mm;
      reports_.insert(reports_.end(), modules, silent);
    }
    return known->second;
  }

  std::map<std::string, ModuleRange> parts_;
  std::vector<std::vector<std::size_t>> numbers_;  // Numbers are indexed by bus and by module of its joint scene.
  std::vector<ModuleReport> reports_;
};

// Runs all buses and returns their samples in the order of arrival.
std::vector<BusSample> samples_until(std::uint64_t until_us, std::deque<WatchedBus>& buses) {
  std::vector<BusSample> arrived;
  for (WatchedBus& bus : buses) bus.run_until(until_us, arrived);
  std::ranges::stable_sort(arrived, {}, &BusSample::arrived_us);
  return arrived;
}

}  // namespace

std::size_t SceneCheck::failed() const {
  return static_cast<std::size_t>(std::ranges::count(results, false, &ExpectationResult::held));
}

SceneCheck check_scene(hardware::Scene scene, const ProgressSink& progress) {
  const std::vector<Expectation> expectations = scene.expectations;
  hardware::JointScene whole{std::move(scene), {""}, {{}}};
  std::vector<hardware::JointScene> buses;
  buses.push_back(std::move(whole));
  return check_buses(std::move(buses), expectations, progress);
}

SceneCheck check_buses(std::vector<hardware::JointScene> buses, const std::vector<Expectation>& expectations,
                       const ProgressSink& progress) {
  if (expectations.empty())
    throw InputError("the scene expects nothing; say what the skin should report with \"expect\" (docs/simulation.md)");
  SkinReports skin(buses);
  std::deque<Watch> watches;
  std::uint64_t end_us = 0;
  for (const Expectation& e : expectations) {
    watches.emplace_back(e, skin.modules_of(e));
    end_us = std::max(end_us, watches.back().end_us());
  }
  const std::uint64_t stop_us = end_us + kStep_us;
  std::deque<WatchedBus> running;
  for (std::size_t b = 0; b < buses.size(); ++b) running.emplace_back(std::move(buses[b].scene), b);
  std::uint64_t now_us = 0;
  while (now_us < stop_us) {
    now_us = std::min(stop_us, now_us + kStep_us);
    for (const BusSample& s : samples_until(now_us, running)) {
      const std::size_t module = skin.take(s);
      for (Watch& w : watches) w.take(module, s.sampled_us, skin.reports());
    }
    report(progress, "simulating", static_cast<double>(now_us) / static_cast<double>(stop_us));
  }
  SceneCheck check;
  for (const WatchedBus& bus : running) check.simulated_s = std::max(check.simulated_s, bus.now_s());
  for (const Watch& w : watches) check.results.push_back(w.result());
  return check;
}

}  // namespace triskin::scenario
