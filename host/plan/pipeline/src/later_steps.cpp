// SPDX-License-Identifier: GPL-3.0-or-later
#include "later_steps.hpp"

#include <algorithm>

#include "triskin/lattice/grow_lattice.hpp"

namespace triskin::pipeline {
namespace {

// The most valuable layouts are priced first, so what a larger share would buy is rarely taken.
constexpr double kMaxPricingShare = 0.1;
// Wiring divides the modules once more and analyses failures; it took up to twice as long as pricing the same layout.
constexpr double kWiringInPricings = 2.0;

}  // namespace

void reserve_later_steps(TimeBudget& budget, double pricing_s, int threads) {
  const double all_layouts_s = pricing_s * std::max(1.0, lattice::kMaxFront / static_cast<double>(threads));
  budget.reserve(kPricingStep, std::max(pricing_s, std::min(all_layouts_s, kMaxPricingShare * budget.limit_s())));
  budget.reserve(kWiringStep, kWiringInPricings * pricing_s);
}

std::function<bool()> give_up_at(const TimeBudget& budget, double end_s, int iterations) {
  if (iterations > 0) return {};
  return budget.is_over(end_s);
}

}  // namespace triskin::pipeline
