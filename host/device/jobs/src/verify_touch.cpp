// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>

#include "triskin/layout/module.hpp"
#include "verification.hpp"

namespace triskin::device {
namespace {

// A chip converts anew every 36.9 ms and is read every 36.9 ms: after both, every value is from after the press.
constexpr std::uint64_t kSettle_us = 85'000;
constexpr std::uint64_t kPersonLimit_us = 15'000'000;
constexpr std::uint64_t kPersonPoll_us = 50'000;
constexpr double kTaxelChange = 60.0;    // counts; noise of the converter is a few counts
constexpr double kModuleChange = 400.0;  // sum over the taxels of a module
constexpr int kMostTaxels = 7;           // of ten: then the whole module was pressed

}  // namespace

void TouchTest::take_rest() {
  for (PatchState& p : patches_) {
    if (p.usable) p.rest = p.controller(bus_).taxels();
  }
}

TouchTest::Response TouchTest::strongest(const PatchState& patch) const {
  const wire::LiveTaxels now = patch.controller(bus_).taxels();
  Response best;
  const std::size_t rows = std::min({now.count, patch.rest.count, patch.image.module_count});
  for (std::size_t row = 0; row < rows; ++row) {
    Response r;
    r.module = patch.module(row);
    for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
      if (!layout::measures_pressure(t) || !now.modules[row].is_valid(t)) continue;
      const double change = std::abs(static_cast<double>(now.modules[row].value[t]) -
                                     static_cast<double>(patch.rest.modules[row].value[t]));
      r.strength += change;
      if (change >= kTaxelChange) r.changed |= 1U << t;
    }
    if (r.strength > best.strength) best = r;
  }
  return best;
}

// Most presses are answered in the patch they were meant for; the others are asked only when not.
TouchTest::Response TouchTest::strongest_anywhere(const PatchState& first) {
  Response best = strongest(first);
  if (std::popcount(best.changed) >= kMostTaxels) return best;
  for (const PatchState& p : patches_) {
    if (!p.usable || &p == &first) continue;
    const Response r = strongest(p);
    if (r.strength > best.strength) best = r;
  }
  return best;
}

std::optional<TouchOutcome> TouchTest::press(int module, const PatchState& patch, const VerifyOptions& options) {
  Response best;
  if (Finger* finger = bus_.link().finger()) {
    finger->press(module);
    bus_.listen(bus_.now_us() + kSettle_us);
    best = strongest_anywhere(patch);
  } else {
    if (!options.ask || !options.ask(module)) return std::nullopt;
    const std::uint64_t limit_us = bus_.now_us() + kPersonLimit_us;
    while (best.strength < kModuleChange && bus_.now_us() < limit_us) {
      bus_.listen(bus_.now_us() + kPersonPoll_us);
      best = strongest_anywhere(patch);
    }
    bus_.listen(bus_.now_us() + kSettle_us);  // the finger is now all the way down
    const Response settled = strongest_anywhere(patch);
    if (settled.strength > best.strength) best = settled;
  }
  const bool whole = std::popcount(best.changed) >= kMostTaxels;
  TouchOutcome outcome{module, best.strength >= kModuleChange ? best.module : -1, whole, 0};
  if (outcome.answered == module && whole) {
    for (unsigned t = 0; t < layout::kTaxelsPerModule; ++t) {
      if (layout::measures_pressure(t) && (best.changed >> t & 1) == 0) outcome.silent_taxels |= 1U << t;
    }
  }
  return outcome;
}

void TouchTest::finish() {
  if (Finger* finger = bus_.link().finger()) finger->lift();
}

}  // namespace triskin::device
