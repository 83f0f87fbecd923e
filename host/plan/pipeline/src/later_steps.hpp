// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/pipeline/time_budget.hpp"

namespace triskin::pipeline {

/// A growth keeps time free for these steps as soon as they can be measured on a layout.
inline constexpr const char* kPricingStep = "pricing";
inline constexpr const char* kWiringStep = "wiring";

/// Reserves what pricing a whole front of layouts and wiring the best one will take, when pricing one layout took
/// `pricing_s`. The layouts are priced on `threads` ≥ 1 threads.
void reserve_later_steps(TimeBudget& budget, double pricing_s, int threads);

/// Returns a deadline at `end_s` of the budget. It is empty with a fixed number of `iterations`, because the result
/// must not depend on the time then.
[[nodiscard]] std::function<bool()> give_up_at(const TimeBudget& budget, double end_s, int iterations);

}  // namespace triskin::pipeline
