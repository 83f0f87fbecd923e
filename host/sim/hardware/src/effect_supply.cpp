// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {
namespace {

constexpr std::uint64_t kForever_us = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Returns the row of each module's parent, or kNone at the cable.
std::vector<std::size_t> parents_of(const design::Patch& patch) {
  std::vector<std::size_t> rows;
  for (const design::RoutedModule& m : patch.modules) {
    const auto parent = std::ranges::find(patch.modules, m.parent, &design::RoutedModule::node);
    rows.push_back(parent == patch.modules.end() ? kNone : static_cast<std::size_t>(parent - patch.modules.begin()));
  }
  return rows;
}

// Returns when the straight line from one point to the next reaches `threshold`.
std::uint64_t crossing_us(const TimedValue& from, const TimedValue& to, double threshold) {
  const double share = (threshold - from.value) / (to.value - from.value);
  return from.at_us + static_cast<std::uint64_t>(std::lround(share * static_cast<double>(to.at_us - from.at_us)));
}

}  // namespace

std::vector<double> supply_drops_v(const SupplyEffect& effect, const design::Patch& patch) {
  const std::vector<std::size_t> parent = parents_of(patch);
  std::vector<int> behind(parent.size(), 0);  // The modules whose current passes here, including the module itself.
  for (std::size_t m = 0; m < parent.size(); ++m) {
    for (std::size_t at = m; at != kNone; at = parent[at]) ++behind[at];
  }
  std::vector<double> drops_v(parent.size(), 0.0);
  for (std::size_t m = 0; m < parent.size(); ++m) {
    for (std::size_t at = m; at != kNone; at = parent[at]) {
      const double ohm = parent[at] == kNone ? effect.cable_ohm : effect.joint_ohm;
      drops_v[m] += ohm * effect.module_ma * 1e-3 * behind[at];
    }
  }
  return drops_v;
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
