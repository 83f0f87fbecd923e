// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>

#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_signal.hpp"
#include "verification.hpp"

namespace triskin::diagnose {
namespace {

// A chip converts every 36.9 ms and is read every 36.9 ms, so after both times every value was measured after the
// press.
constexpr std::uint64_t kSettle_us = 85'000;
constexpr std::uint64_t kPersonLimit_us = 15'000'000;
constexpr std::uint64_t kPersonPoll_us = 50'000;
// The limit of a module applies to the sum of its taxels' changes, to which noise alone adds some 30 counts; a finger
// of half a newton adds 130.
constexpr double kTaxelChange_counts = layout::kPressed_counts, kModuleChange_counts = 6.0 * layout::kPressed_counts;
constexpr int kMaxTaxels = 7;    // If this many of the ten pressure taxels change, the whole module was pressed.
constexpr double kTip_mm = 2.5;  // A finger tip reaches this far from its centre.

// For turns of 0, 120 and 240°, this taxel is under a finger tip; −1 means that the turns cannot be distinguished.
struct TurnProbe {
  std::array<int, 3> taxel{-1, -1, -1};
};

int taxel_under(const std::array<design::TaxelPose, layout::kTaxelsPerModule>& taxels, const design::Vec3& tip) {
  int best = -1;
  double distance_mm = kTip_mm;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const double d = (taxels[t].position_mm - tip).norm();
    if (d >= distance_mm || !layout::measures_pressure(t)) continue;
    distance_mm = d;
    best = static_cast<int>(t);
  }
  return best;
}

TurnProbe turn_probe(const design::PlacedModule& module, int rotation) {
  const auto straight = design::taxels_of(module, rotation), once = design::taxels_of(module, (rotation + 1) % 3),
             twice = design::taxels_of(module, (rotation + 2) % 3);
  for (std::size_t t = 0; t < straight.size(); ++t) {
    if (!layout::measures_pressure(t)) continue;
    const design::Vec3& tip = straight[t].position_mm;
    const TurnProbe probe{{static_cast<int>(t), taxel_under(once, tip), taxel_under(twice, tip)}};
    const auto [a, b, c] = probe.taxel;
    if (b >= 0 && c >= 0 && a != b && b != c && a != c) return probe;
  }
  return {};
}

}  // namespace

void TouchTest::take_rest() {
  for (PatchState& p : patches_) {
    if (p.usable) p.rest = p.controller(bus_).taxels();
  }
}

TouchTest::Response TouchTest::response_of(const PatchState& patch, std::size_t row,
                                           const wire::LiveTaxels& now) const {
  Response r;
  r.module = patch.module(row);
  const double warming = pads_change_counts(now.modules[row], patch.rest.modules[row].value);
  for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (!layout::measures_pressure(t) || !now.modules[row].is_valid(t)) continue;
    const double change = std::abs(static_cast<double>(now.modules[row].value[t]) -
                                   static_cast<double>(patch.rest.modules[row].value[t]) - warming);
    r.strength += change;
    if (change >= kTaxelChange_counts) r.changed |= 1U << t;
    if (change <= r.taxel_counts) continue;
    r.taxel_counts = change;
    r.taxel = layout::TaxelIndex{t};
  }
  return r;
}

TouchTest::Response TouchTest::strongest(const PatchState& patch) const {
  const wire::LiveTaxels now = patch.controller(bus_).taxels();
  Response best;
  const std::size_t rows = std::min({now.count, patch.rest.count, patch.image.module_count});
  for (std::size_t row = 0; row < rows; ++row) {
    const Response r = response_of(patch, row, now);
    if (r.strength > best.strength) best = r;
  }
  return best;
}

// Presses a single taxel: if the module is turned, another taxel feels it.
int TouchTest::turned(link::TouchActuator& actuator, layout::ModuleId module, const PatchState& patch) {
  const int rotation = wiring_[static_cast<std::size_t>(module)].routed.rotation;
  const TurnProbe probe = turn_probe(design_.layout.modules[static_cast<std::size_t>(module)], rotation);
  if (probe.taxel[0] < 0) return 0;
  actuator.press({module, layout::TaxelIndex{probe.taxel[0]}});
  bus_.listen(bus_.now_us() + kSettle_us);
  const wire::LiveTaxels now = patch.controller(bus_).taxels();
  for (std::size_t row = 0; row < std::min(now.count, patch.image.module_count); ++row) {
    if (patch.module(row) != module) continue;
    const Response r = response_of(patch, row, now);
    const auto found = std::ranges::find(probe.taxel, r.taxel_counts >= kTaxelChange_counts ? r.taxel.value() : -1);
    return found == probe.taxel.end() ? 0 : static_cast<int>(found - probe.taxel.begin());
  }
  return 0;
}

// Most presses are answered in the intended patch; the others are asked only if that one does not answer.
TouchTest::Response TouchTest::strongest_anywhere(const PatchState& first) {
  Response best = strongest(first);
  if (std::popcount(best.changed) >= kMaxTaxels) return best;
  for (const PatchState& p : patches_) {
    if (!p.usable || &p == &first) continue;
    const Response r = strongest(p);
    if (r.strength > best.strength) best = r;
  }
  return best;
}

TouchTest::Response TouchTest::response_to_actuator(layout::ModuleId module, const PatchState& patch) {
  actuator_->press(module);
  bus_.listen(bus_.now_us() + kSettle_us);
  const Response first = strongest_anywhere(patch);
  if (std::popcount(first.changed) >= kMaxTaxels) return first;
  // A controller that looks for a missing module may skip a sequence: only what a second look does not see is not
  // there.
  bus_.listen(bus_.now_us() + kSettle_us);
  const Response second = strongest_anywhere(patch);
  return second.strength > first.strength ? second : first;
}

TouchTest::Response TouchTest::response_to_person(const PatchState& patch) {
  Response best;
  const std::uint64_t limit_us = bus_.now_us() + kPersonLimit_us;
  while (best.strength < kModuleChange_counts && bus_.now_us() < limit_us) {
    bus_.listen(bus_.now_us() + kPersonPoll_us);
    best = strongest_anywhere(patch);
  }
  bus_.listen(bus_.now_us() + kSettle_us);  // After this time the finger presses fully.
  const Response settled = strongest_anywhere(patch);
  return settled.strength > best.strength ? settled : best;
}

unsigned TouchTest::silent_taxels(const Response& response) {
  unsigned silent = 0;
  for (unsigned t = 0; t < layout::kTaxelsPerModule; ++t) {
    if (layout::measures_pressure(t) && (response.changed >> t & 1) == 0) silent |= 1U << t;
  }
  return silent;
}

std::optional<TouchOutcome> TouchTest::press(layout::ModuleId module, const PatchState& patch,
                                             const VerifyOptions& options) {
  if (actuator_ == nullptr && (!options.ask || !options.ask(module))) return std::nullopt;
  const Response best = actuator_ != nullptr ? response_to_actuator(module, patch) : response_to_person(patch);
  const bool whole = std::popcount(best.changed) >= kMaxTaxels;
  TouchOutcome outcome{module, best.strength >= kModuleChange_counts ? best.module : layout::ModuleId::none(), whole, 0,
                       0};
  if (outcome.answered == module && whole) {
    outcome.silent_taxels = silent_taxels(best);
    if (actuator_ != nullptr) outcome.turned = turned(*actuator_, module, patch);
  }
  return outcome;
}

void TouchTest::finish() {
  if (actuator_ != nullptr) actuator_->lift();
}

}  // namespace triskin::diagnose
