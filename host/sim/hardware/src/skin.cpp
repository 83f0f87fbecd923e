// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/skin.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "change_times.hpp"
#include "chip_places.hpp"
#include "triskin/layout/rest.hpp"

namespace triskin::hardware {
namespace {

// The value is beyond the converter's range, as with a pad shorted to the shield.
constexpr double kSaturatedCounts = -1e6;
constexpr std::uint64_t kForgetAfterUs = 1'000'000;
// Whole steps of an ideal converter's offset cancel this electrode exactly.
constexpr double kShownElectrode_counts = 20 * Ad7147Behaviour{}.step_counts;
// A separate stream keeps the electrodes' random numbers unchanged.
constexpr std::uint64_t kSensitivityStream = 0x100, kHumidityStream = 0x200, kEmiStream = 0x300;

// SplitMix64 (Steele, Lea, Flood 2014) hashes each sample, so that noise needs no state.
std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

double uniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

double gaussian(std::uint64_t seed) {
  const double u = std::max(uniform(mix(seed)), 0x1p-53);
  const double angle = 2.0 * std::numbers::pi * uniform(mix(seed ^ 0x5DEECE66DULL));
  return std::sqrt(-2.0 * std::log(u)) * std::cos(angle);
}

std::uint64_t drawn_from(const Scene& scene, layout::ModuleId module) {
  if (!scene.module_seeds.empty()) return scene.module_seeds.at(static_cast<std::size_t>(module));
  return static_cast<std::uint64_t>(module) << 32;
}

}  // namespace

double Touch::pressure_kpa(const design::Vec3& at_mm, std::uint64_t at_us) const {
  if (at_us >= released_us) return 0.0;
  const auto now = state_of(contact, at_us);
  if (!now) return 0.0;
  if (footprint != nullptr)
    return now->force_n * footprint->kpa_per_newton(now->radius_mm, (at_mm - now->position_mm).norm());
  const double r = now->radius_mm;
  const double ratio2 = (at_mm - now->position_mm).squaredNorm() / (r * r);
  if (ratio2 >= 1.0) return 0.0;
  constexpr double kKpaPerNewtonPerMm2 = 1000.0;
  return kKpaPerNewtonPerMm2 * 3.0 * now->force_n / (2.0 * std::numbers::pi * r * r) * std::sqrt(1.0 - ratio2);
}

double PressureCurve::kpa(std::uint64_t at_us) const {
  const auto next = std::ranges::upper_bound(points_, at_us, {}, &Point::at_us);
  if (points_.empty()) return 0.0;
  if (next == points_.begin()) return next->kpa;
  const Point& last = *std::prev(next);
  if (next == points_.end()) return last.kpa;
  const double share = static_cast<double>(at_us - last.at_us) / static_cast<double>(next->at_us - last.at_us);
  return last.kpa + share * (next->kpa - last.kpa);
}

void PressureCurve::step(std::uint64_t at_us, double kpa) {
  const double before = this->kpa(at_us);
  const auto planned = std::ranges::lower_bound(points_, at_us, {}, &Point::at_us);
  points_.erase(planned, points_.end());
  points_.push_back({at_us, before});
  points_.push_back({at_us, kpa});
}

ModuleSkin::ModuleSkin(const Scene& scene, layout::ModuleId module, int rotation)
    : pressure_(scene.pressure),
      seed_(mix(scene.seed ^ drawn_from(scene, module))),
      noise_counts_(scene.effects.noise_counts),
      drift_counts_per_us_(scene.effects.drift_counts_per_s * 1e-6) {
  if (scene.effects.pads.act_on_samples()) effects_ = std::make_shared<const PadEffects>(scene.effects.pads);
  const auto taxels = design::taxels_of(scene.design.layout.modules[static_cast<std::size_t>(module)], rotation);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    position_mm_[t] = taxels[t].position_mm;
    const Effects& e = scene.effects;
    const double spread = e.taxel_spread_counts * (2.0 * uniform(mix(seed_ + t)) - 1.0);
    const double electrode_pf =
        e.electrode_least_pf + (e.electrode_most_pf - e.electrode_least_pf) * uniform(mix(seed_ ^ mix(t)));
    rest_counts_[t] = electrode_pf * kCountsPerPf + spread;
    const double deviation = e.sensitivity_spread * (2.0 * uniform(mix(seed_ ^ mix(t + kSensitivityStream))) - 1.0);
    counts_per_kpa_[t] = kCountsPerKpa * (1.0 + deviation);
  }
}

double ModuleSkin::counts(int cin, std::uint64_t at_us) const {
  const auto taxel = static_cast<std::size_t>(cin);
  if (taxel >= rest_counts_.size()) return 0.0;
  if (shown_counts_) return kShownElectrode_counts + layout::kRestCounts - (*shown_counts_)[taxel];
  double value = rest_counts_[taxel];
  for (const BrokenTaxel& b : broken_) {
    if (b.taxel == taxel && at_us >= b.from_us && at_us < b.until_us) return b.saturated ? kSaturatedCounts : value;
  }
  const double by_pressure = pressure_counts(taxel, at_us);
  value += by_pressure;
  if (effects_) value += effect_counts(taxel, by_pressure, at_us);
  if (drift_counts_per_us_ != 0.0) value += drift_counts_per_us_ * static_cast<double>(at_us);
  for (const Drift& d : drifts_) {
    if (at_us > d.from_us) value += d.counts_per_us * static_cast<double>(std::min(at_us, d.until_us) - d.from_us);
  }
  if (noise_counts_ != 0.0) value += noise_counts_ * gaussian(seed_ ^ (at_us * 16 + taxel));
  return value;
}

bool ModuleSkin::is_stuck(int cin, std::uint64_t at_us) const {
  return std::ranges::any_of(broken_, [&](const BrokenTaxel& b) {
    return b.taxel == static_cast<std::size_t>(cin) && at_us >= b.from_us && at_us < b.until_us;
  });
}

double ModuleSkin::pressure_counts(std::size_t taxel, std::uint64_t at_us) const {
  if (!layout::measures_pressure(taxel)) return 0.0;
  double kpa = pressure_.kpa(at_us);
  for (const Touch* touch : touches_) kpa += touch->pressure_kpa(position_mm(taxel, at_us), at_us);
  return counts_per_kpa_[taxel] * kpa;
}

double ModuleSkin::effect_counts(std::size_t taxel, double by_pressure, std::uint64_t at_us) const {
  double counts = 0.0;
  if (effects_->temperature) counts += temperature_counts(*effects_->temperature, at_us);
  if (effects_->humidity) {
    const double unit = 2.0 * uniform(mix(seed_ ^ mix(taxel + kHumidityStream))) - 1.0;
    counts += humidity_counts(*effects_->humidity, unit, at_us);
  }
  if (effects_->crosstalk) {
    double sum = 0.0;
    for (std::size_t t = 0; t < rest_counts_.size(); ++t) sum += pressure_counts(t, at_us);
    counts += crosstalk_counts(*effects_->crosstalk, by_pressure, sum);
  }
  if (const double deviation = emi_deviation_counts(effects_->emi, at_us); deviation > 0.0)
    counts += deviation * gaussian(mix(seed_ + kEmiStream) ^ (at_us * 16 + taxel));
  return counts;
}

const design::Vec3& ModuleSkin::position_mm(std::size_t taxel, std::uint64_t at_us) const {
  for (auto turn = turns_.rbegin(); turn != turns_.rend(); ++turn) {
    if (at_us >= turn->from_us) return turn->position_mm[taxel];
  }
  return position_mm_[taxel];
}

bool ModuleSkin::reached_by(const Contact& contact, double beyond_mm) const {
  const auto any_of = [&](const auto& places) {
    return std::ranges::any_of(places, [&](const design::Vec3& p) {
      return beyond_mm > 0.0 ? distance_mm(contact, p) < max_radius_mm(contact) + beyond_mm : reaches(contact, p);
    });
  };
  return any_of(position_mm_) || std::ranges::any_of(turns_, [&](const Turn& t) { return any_of(t.position_mm); });
}

void ModuleSkin::add(const Touch& touch) {
  touches_.push_back(&touch);
}

void ModuleSkin::remove(int touch_id) {
  std::erase_if(touches_, [&](const Touch* t) { return t->id == touch_id; });
}

Skin::Skin(const Scene& scene, SwitchedHardware* switched) : lines_(scene.design.patches.size()) {
  for (layout::ModuleId m; m < static_cast<int>(scene.design.layout.modules.size()); ++m)
    modules_.emplace_back(scene, m, real_rotation(scene, m));
  if (const auto& layer = scene.effects.pads.layer) {
    // Only Poisson's ratio and the thickness affect the footprint, so any modulus will do.
    footprint_.emplace(mechanics::Layer{layer->thickness_mm, layer->poisson, 100.0}, layer->electrode_mm);
  }
  turn_modules(scene);
  place_chips(scene, switched);
  if (scene.effects.pads.supply) brown_out(*scene.effects.pads.supply, scene.design);
  if (scene.effects.pads.edges) silence_slow_lines(*scene.effects.pads.edges, scene.design);
  for (const Fault& fault : scene.faults) {
    apply(fault);
    if (fault.kind != FaultKind::kLoosePlug) continue;
    for (const design::RoutedModule& m : modules_from(scene.design, fault.module))
      chips_[static_cast<std::size_t>(m.node)]->schedule_outage(fault.from_us, fault.until_us);
  }
  for (const Contact& contact : scene.contacts) press(contact);
}

// Handles modules that are turned, or turned back, while the skin runs.
void Skin::turn_modules(const Scene& scene) {
  std::set<std::uint64_t> times =
      change_times_us(scene, [](const Fault& f) { return f.kind == FaultKind::kRotatedModule; });
  times.erase(0);
  for (const std::uint64_t at_us : times) {
    for (const Fault& f : scene.faults) {
      if (f.kind != FaultKind::kRotatedModule || (f.from_us != at_us && f.until_us != at_us)) continue;
      const auto m = static_cast<std::size_t>(f.module);
      std::array<design::Vec3, layout::kTaxelsPerModule> places;
      const auto taxels = design::taxels_of(scene.design.layout.modules[m], real_rotation(scene, f.module, at_us));
      std::ranges::transform(taxels, places.begin(), &design::TaxelPose::position_mm);
      modules_[m].turn(at_us, places);
    }
  }
}

namespace {

// Attaches a chip to each line on which it is at some time.
void attach_strapped(Skin& skin, Ad7147& chip, const ChipPlaces& places) {
  const ChipPlace& first = places[0].place;
  if (places.size() == 1) {
    if (first.patch >= 0) skin.line(first.patch, first.line).attach(chip, layout::cdc_address(first.address));
    return;
  }
  std::set<std::pair<layout::PatchIndex, int>> lines;  // A patch and its line.
  for (const PlaceFrom& p : places) {
    if (p.place.patch >= 0) lines.insert({p.place.patch, p.place.line});
  }
  for (const auto& at : lines) {
    skin.line(at.first, at.second).attach(chip, [places, at](std::uint64_t now_us) -> int {
      const ChipPlace now = place_at(places, now_us);
      return std::pair(now.patch, now.line) == at ? layout::cdc_address(now.address) : -1;
    });
  }
}

// Attaches a switched module's chip to all lines: its register selects line and address while its ports lead to the
// controller.
void attach_switched(Skin& skin, Ad7147& chip, layout::ModuleId module, const ChipPlaces& places, std::size_t patches,
                     SwitchedHardware& switched) {
  const auto there = std::ranges::find_if(places, [](const PlaceFrom& p) { return p.place.patch >= 0; });
  SwitchedPatch& chain = switched.patch(there->place.patch);
  const layout::TableRow row = switched.row_of(module);
  const bool stays = places.size() == 1;
  for (std::size_t p = 0; p < patches; ++p) {
    if (&switched.patch(layout::PatchIndex{p}) != &chain) continue;
    const int controller = switched.controller_of(layout::PatchIndex{p});
    for (int l = 0; l < layout::kLines; ++l) {
      I2cLineModel& model = skin.line(layout::PatchIndex{p}, l);
      model.attach(chip, [&chain, controller, row, l, stays, places](std::uint64_t now_us) -> int {
        const bool is_away = !stays && place_at(places, now_us).patch < 0;
        const bool is_here = chain.controller_of(row) == controller && chain.line_of(row) == l;
        return !is_away && is_here ? layout::cdc_address(chain.address_of(row)) : -1;
      });
      if (row == 0) model.hold_while([&chain, controller, l] { return (chain.stuck_lines(controller) >> l & 1) != 0; });
    }
  }
}

}  // namespace

// Finds the place of each chip after the faults that move chips, then attaches the chips that exist.
void Skin::place_chips(const Scene& scene, SwitchedHardware* switched) {
  const std::vector<ChipPlaces> places = chip_places(scene);
  const auto wiring = design::wiring_of(scene.design);
  for (std::size_t m = 0; m < places.size(); ++m) {
    chips_.push_back(std::make_unique<Ad7147>(modules_[m]));
    Ad7147& chip = *chips_.back();
    const std::uint64_t serial = mix(scene.seed ^ drawn_from(scene, layout::ModuleId{m}));
    Ad7147Behaviour behaviour = scene.effects.converters.of(serial);
    behaviour.bus_coupling_counts = scene.effects.bus_coupling_counts;
    chip.set_behaviour(behaviour);
    if (scene.effects.converters.drawn) chip.set_noise(serial | 1);
    const bool never_there = places[m].size() == 1 && places[m][0].place.patch < 0;
    if (wiring[m].patch < 0 || never_there) continue;
    if (switched != nullptr && switched->present())
      attach_switched(*this, chip, layout::ModuleId{m}, places[m], lines_.size(), *switched);
    else
      attach_strapped(*this, chip, places[m]);
  }
}

void Skin::brown_out(const SupplyEffect& supply, const design::Design& design) {
  for (const design::Patch& patch : design.patches) {
    const std::vector<double> drops_v = supply_drops_v(supply, patch);
    for (std::size_t row = 0; row < drops_v.size(); ++row) {
      Ad7147& chip = *chips_[static_cast<std::size_t>(patch.modules[row].node)];
      for (const Outage& o : outages_of(supply, drops_v[row])) chip.schedule_outage(o.from_us, o.until_us);
    }
  }
}

void Skin::silence_slow_lines(const EdgeEffect& edges, const design::Design& design) {
  for (const design::Patch& patch : design.patches) {
    for (const design::RoutedModule& m : patch.modules) {
      const auto line = static_cast<std::size_t>(m.line);
      const double capacitance_pf = line < patch.lines.size() ? patch.lines[line].capacitance_pf : 0.0;
      if (rise_to_high_us(edges, capacitance_pf) <= edges.settling_us) continue;
      chips_[static_cast<std::size_t>(m.node)]->schedule_outage(0, Ad7147::kNever);
    }
  }
}

void Skin::apply(const Fault& f) {
  switch (f.kind) {
    case FaultKind::kStuckLine:
      line(f.patch, f.line)
          .hold_low(f.stuck_scl ? I2cLineModel::Signal::kScl : I2cLineModel::Signal::kSda, f.from_us,
                    f.frees_after_pulses, f.until_us);
      break;
    case FaultKind::kLostConfiguration:
      chips_[static_cast<std::size_t>(f.module)]->schedule_power_dip(f.from_us, f.every_us, f.until_us);
      break;
    case FaultKind::kSaturatedTaxel:
      modules_[static_cast<std::size_t>(f.module)].saturate(f.taxel, f.from_us, f.until_us);
      break;
    case FaultKind::kFrozenTaxel:
      modules_[static_cast<std::size_t>(f.module)].freeze(f.taxel, f.from_us, f.until_us);
      break;
    case FaultKind::kDriftingChip:
      modules_[static_cast<std::size_t>(f.module)].drift(f.value, f.from_us, f.until_us);
      break;
    case FaultKind::kWrongId:
      chips_[static_cast<std::size_t>(f.module)]->show_device_id(static_cast<std::uint16_t>(f.value), f.from_us,
                                                                 f.until_us);
      break;
    case FaultKind::kRemovedChip:
    case FaultKind::kMovedChip:
    case FaultKind::kSwappedChips:
    case FaultKind::kFingerElsewhere:
    default:
      break;  // Such faults are handled where chips are placed, at the finger or at the controllers.
  }
}

I2cLineModel& Skin::line(layout::PatchIndex patch, int line) {
  return lines_.at(static_cast<std::size_t>(patch)).at(static_cast<std::size_t>(line));
}

int Skin::press(const Contact& contact) {
  const int id = next_touch_++;
  const Touch& touch = touches_.emplace_back(Touch{id, contact, kForever, footprint_ ? &*footprint_ : nullptr});
  const double radius_mm = max_radius_mm(contact);
  const double beyond_mm = footprint_ ? std::max(0.0, footprint_->reach_mm(radius_mm) - radius_mm) : 0.0;
  for (ModuleSkin& m : modules_) {
    if (m.reached_by(contact, beyond_mm)) m.add(touch);
  }
  return id;
}

void Skin::pressurize(layout::ModuleId module, double kpa, std::uint64_t now_us) {
  if (module >= 0) return modules_.at(static_cast<std::size_t>(module)).pressurize(kpa, now_us);
  for (ModuleSkin& m : modules_) m.pressurize(kpa, now_us);
}

void Skin::release(int id, std::uint64_t now_us) {
  for (Touch& t : touches_) {
    if (t.id == id) t.released_us = std::min(t.released_us, now_us);
  }
  if (now_us > kForgetAfterUs) forget(now_us - kForgetAfterUs);
}

void Skin::forget(std::uint64_t before_us) {
  for (auto t = touches_.begin(); t != touches_.end();) {
    if (std::min(t->released_us, end_of(t->contact)) >= before_us) {
      ++t;
      continue;
    }
    for (ModuleSkin& m : modules_) m.remove(t->id);
    t = touches_.erase(t);
  }
}

}  // namespace triskin::hardware
