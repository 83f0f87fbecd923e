// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/design/supply.hpp"
#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {
namespace {

constexpr std::uint64_t kForever_us = std::numeric_limits<std::uint64_t>::max();

// Returns when the straight line from one point to the next reaches `threshold`.
std::uint64_t crossing_us(const TimedValue& from, const TimedValue& to, double threshold) {
  const double share = (threshold - from.value) / (to.value - from.value);
  return from.at_us + static_cast<std::uint64_t>(std::lround(share * static_cast<double>(to.at_us - from.at_us)));
}

}  // namespace

std::vector<double> supply_drops_v(const SupplyEffect& effect, const design::Patch& patch) {
  std::vector<double> ohm;
  for (const design::RoutedModule& m : patch.modules) ohm.push_back(m.parent < 0 ? effect.cable_ohm : effect.joint_ohm);
  return design::supply_drops_v(patch, effect.module_ma, ohm);
}

std::vector<Outage> outages_of(const SupplyEffect& effect, double drop_v) {
  const double threshold_v = effect.brown_out_v + drop_v;
  std::vector<Outage> outages;
  bool is_out = false;
  const auto change = [&](bool out, std::uint64_t at_us) {
    if (out == is_out) return;
    if (out)
      outages.push_back({at_us, kForever_us});
    else
      outages.back().until_us = at_us;
    is_out = out;
  };
  for (std::size_t k = 0; k < effect.volts.size(); ++k) {
    const TimedValue& now = effect.volts[k];
    const bool out = now.value < threshold_v;
    if (k == 0)
      change(out, 0);
    else
      change(out, out == is_out ? now.at_us : crossing_us(effect.volts[k - 1], now, threshold_v));
  }
  return outages;
}

}  // namespace triskin::hardware
