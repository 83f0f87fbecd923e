// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/skin/touch_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/layout/rest.hpp"

namespace triskin::skin {

std::optional<double> warming_counts(const wire::TaxelFrame& sample,
                                     const std::array<double, layout::kTaxelsPerModule>& rest) {
  double sum = 0.0;
  int known = 0;
  for (const std::size_t t : layout::kTemperaturePads) {
    if ((sample.valid >> t & 1) == 0 || std::isnan(rest[t])) continue;
    sum += rest[t] - sample.value[t];
    ++known;
  }
  if (known == 0) return std::nullopt;
  return sum / known;
}

TouchMap::TouchMap(const design::Design& design, const design::KnownRest& rest)
    : design_(design), wiring_(design::wiring_of(design)), modules_(design.layout.modules.size()) {
  set_rest(rest.kept, layout::ModuleId{});
  settle(rest.settled);
}

void TouchMap::set_rest(const design::RestValues& rest, layout::ModuleId first_module) {
  for (std::size_t m = 0; m < rest.size(); ++m) {
    Module& module = modules_.at(static_cast<std::size_t>(first_module) + m);
    module.tared = true;
    for (std::size_t t = 0; t < rest[m].size(); ++t) {
      Taxel& taxel = module.taxels[t];
      taxel.rest = taxel.now = rest[m][t];
      taxel.seen = kRestSamples;
    }
  }
}

// The pads have not felt a finger, so what they read then is their rest value.
void TouchMap::settle(const design::RestValues& settled) {
  for (std::size_t m = 0; m < settled.size(); ++m) {
    Module& module = modules_.at(m);
    if (module.tared) continue;
    for (std::size_t t = 0; t < settled[m].size(); ++t) module.taxels[t].settled = settled[m][t];
    for (const std::size_t t : layout::kTemperaturePads) {
      Taxel& pad = module.taxels[t];
      if (std::isnan(pad.settled)) continue;
      pad.rest = pad.now = pad.settled;
      pad.seen = kRestSamples;
    }
  }
}

// A value above the band can only be rest, because pressure lowers it.
bool TouchMap::may_rest(const Taxel& taxel, double value) {
  return std::isnan(taxel.settled) || value >= taxel.settled - kRestBand_counts;
}

// Adds a value to the first ones; returns their median when there are enough of them. The median tolerates one sample
// from a finger that was lifted just before.
std::optional<double> TouchMap::collected(Taxel& taxel, double value) {
  taxel.first[taxel.seen++] = value;
  if (taxel.seen < kRestSamples) return std::nullopt;
  std::ranges::sort(taxel.first);
  return taxel.first[kRestSamples / 2];
}

void TouchMap::take_first(const Module& module, Taxel& taxel, double median) {
  const bool at_rest = module.tared || may_rest(taxel, median);
  taxel.rest = at_rest ? median : taxel.settled;
  taxel.follows = !module.tared && at_rest;
  taxel.awaited = !at_rest;
}

void TouchMap::take(const Module& module, Taxel& taxel, double value) {
  if (taxel.seen < kRestSamples) {
    const auto median = collected(taxel, value);
    if (!median) return;
    take_first(module, taxel, *median);
  }
  taxel.now = value;
  if (taxel.awaited && may_rest(taxel, value)) {
    taxel.awaited = false;
    taxel.follows = true;
    taxel.rest = value;
  }
  if (taxel.follows) follow(taxel, value);
}

// A light touch at the start can lie within the band; when it ends, the value rises to the true rest. The greatest
// value of all would be the rest value plus five deviations of the noise, so a small excess counts in part only.
void TouchMap::follow(Taxel& taxel, double value) {
  constexpr double kExcess_counts = kPressed_counts / 2.0, kLifted_counts = 2.0 * kPressed_counts;
  constexpr double kShare = 1.0 / 4.0;
  const double above = value - taxel.rest;
  if (above > kLifted_counts)
    taxel.rest = value;
  else if (above > kExcess_counts)
    taxel.rest += kShare * above;
}

// A finger does not affect the temperature pads, so their first reading is their rest value.
void TouchMap::take_pads(Module& module, const wire::TaxelFrame& sample) {
  std::array<double, layout::kTaxelsPerModule> rest{};
  for (const std::size_t t : layout::kTemperaturePads) {
    Taxel& pad = module.taxels[t];
    if ((sample.valid >> t & 1) != 0) {
      pad.now = sample.value[t];
      if (pad.seen < kRestSamples) pad.rest = collected(pad, pad.now).value_or(pad.rest);
    }
    rest[t] = pad.seen == kRestSamples ? pad.rest : std::numeric_limits<double>::quiet_NaN();
  }
  // Temperature changes slowly, so a mean over about eight samples keeps the noise of the two pads out of ten taxels. A
  // leap is no temperature: the controller has found other offsets.
  constexpr double kShare = 1.0 / 8.0, kLeap_counts = 2.0 * kPressed_counts;
  const auto warming = warming_counts(sample, rest);
  if (!warming) return;
  const double change = *warming - module.warming_counts.value_or(*warming);
  const bool is_leap = !module.warming_counts || std::abs(change) > kLeap_counts;
  module.warming_counts = is_leap ? *warming : *module.warming_counts + kShare * change;
}

void TouchMap::add(const session::ModuleSample& frame) {
  Module& module = modules_[static_cast<std::size_t>(frame.module)];
  take_pads(module, frame.sample);
  for (std::size_t t = 0; t < module.taxels.size(); ++t) {
    if (!layout::measures_pressure(t)) continue;
    Taxel& taxel = module.taxels[t];
    if ((frame.sample.valid >> t & 1) != 0)
      take(module, taxel, frame.sample.value[t] + module.warming_counts.value_or(0.0));
    else
      taxel.now = taxel.rest;  // An invalid taxel must not count as pressed.
  }
}

void TouchMap::tare() {
  for (Module& module : modules_) {
    module = Module{};
    module.tared = true;
  }
}

bool TouchMap::tared() const {
  return std::ranges::all_of(modules_, [](const Module& module) {
    return std::ranges::all_of(module.taxels, [](const Taxel& t) { return t.seen == 0 || t.seen == kRestSamples; });
  });
}

design::RestValues TouchMap::rest() const {
  design::RestValues rest(modules_.size());
  for (std::size_t m = 0; m < modules_.size(); ++m) {
    for (std::size_t t = 0; t < rest[m].size(); ++t) {
      const Taxel& taxel = modules_[m].taxels[t];
      rest[m][t] = taxel.seen == kRestSamples ? taxel.rest : layout::kRestCounts;
    }
  }
  return rest;
}

std::array<double, layout::kTaxelsPerModule> TouchMap::change(layout::ModuleId module) const {
  std::array<double, layout::kTaxelsPerModule> change{};
  const auto& taxels = modules_[static_cast<std::size_t>(module)].taxels;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    if (taxels[t].seen == kRestSamples && layout::measures_pressure(t)) change[t] = taxels[t].rest - taxels[t].now;
  }
  return change;
}

std::vector<PressedTaxel> TouchMap::pressed() const {
  std::vector<PressedTaxel> pressed;
  for (std::size_t k = 0; k < modules_.size(); ++k) {
    std::array<design::TaxelPose, layout::kTaxelsPerModule> poses;
    bool posed = false;
    const auto changes = change(layout::ModuleId{k});
    for (std::size_t t = 0; t < changes.size(); ++t) {
      if (changes[t] < kPressed_counts) continue;
      if (!posed) poses = design::taxels_of(design_.layout.modules[k], wiring_[k].routed.rotation);
      posed = true;
      pressed.push_back(
          {layout::ModuleId{k}, layout::TaxelIndex{t}, changes[t], poses[t].position_mm, poses[t].normal});
    }
  }
  std::ranges::sort(pressed, std::greater{}, &PressedTaxel::change_counts);
  return pressed;
}

}  // namespace triskin::skin
