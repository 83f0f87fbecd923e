// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>

#include "triskin/hardware/ad7147.hpp"

namespace triskin::hardware {

/// A property in which the converters of a series differ: a number, or a behaviour that a chip has or has not.
struct ConverterProperty {
  std::string_view key;  ///< its name in scene files
  double Ad7147Behaviour::* number = nullptr;
  bool Ad7147Behaviour::* flag = nullptr;    ///< instead of a number
  double drawn_low = 0.0, drawn_high = 1.0;  ///< chips are drawn evenly from this range; a flag is set in half of them
  double lowest = 0.0, highest = 1.0;        ///< a scene may set this range
  std::string_view source;                   ///< why the range is as it is
};

/// Everything that the firmware relies on and no data sheet bounds to zero (docs/silicon.md shows the same list).
inline constexpr std::array<ConverterProperty, 21> kConverterProperties{{
    {"step_counts", &Ad7147Behaviour::step_counts, nullptr, 900, 1'400, 500, 2'500,
     "970 by the flow3r badge's driver, 1,000 seen with the evaluation kit, 1,311 by the data sheet's 0.32 pF"},
    {"neg_step_ratio", &Ad7147Behaviour::neg_step_ratio, nullptr, 0.9, 1.1, 0.5, 2.0,
     "nobody knows; the AD7747, of another family, calls its two DACs well matched"},
    {"step_bend", &Ad7147Behaviour::step_bend, nullptr, -0.05, 0.05, -0.5, 0.5, "nobody knows"},
    {"neg_step_bend", &Ad7147Behaviour::neg_step_bend, nullptr, -0.05, 0.05, -0.5, 0.5, "nobody knows"},
    {"step_unevenness", &Ad7147Behaviour::step_unevenness, nullptr, 0.0, 0.05, 0.0, 0.5,
     "nobody knows; the AD7747's DACs are monotonic"},
    {"zero_counts", &Ad7147Behaviour::zero_counts, nullptr, -200, 200, -5'000, 5'000, "nobody knows; 49 fF"},
    {"neg_extra_counts", &Ad7147Behaviour::neg_extra_counts, nullptr, 0, 400, -5'000, 5'000,
     "nobody knows; 98 fF, a few mm of track on a chip's lead frame"},
    {"path_spread_counts", &Ad7147Behaviour::path_spread_counts, nullptr, 0, 20, 0, 1'000, "nobody knows; 5 fF"},
    {"neg_gain_ratio", &Ad7147Behaviour::neg_gain_ratio, nullptr, 0.98, 1.02, 0.5, 2.0,
     "nobody knows; one converter serves both inputs"},
    {"stage_gain_spread", &Ad7147Behaviour::stage_gain_spread, nullptr, 0.0, 0.002, 0.0, 0.5,
     "nobody knows; one converter serves all stages"},
    {"curve_counts", &Ad7147Behaviour::curve_counts, nullptr, -50, 50, -5'000, 5'000,
     "nobody knows; 0.15 % of half the range"},
    {"noise", &Ad7147Behaviour::noise, nullptr, 0.5, 2.0, 0.0, 100.0,
     "of the data sheet's 12, 7, 3 counts peak to peak; typical values, limits unknown"},
    {"wander_counts", &Ad7147Behaviour::wander_counts, nullptr, 0.0, 2.0, 0.0, 100.0,
     "nobody knows the 1/f noise; a wave of some seconds stands for it"},
    {"period_error", &Ad7147Behaviour::period_error, nullptr, -0.1, 0.1, -0.3, 0.3,
     "limits unknown; 4 % are typical of the maker's oscillators"},
    {"first_error_counts", &Ad7147Behaviour::first_error_counts, nullptr, 0, 10, 0, 10'000,
     "nobody knows; users of the flow3r badge saw glitches when sequences alternate"},
    {"latched_at_end", nullptr, &Ad7147Behaviour::latched_at_end, 0, 1, 0, 1,
     "open; the AD7148's data sheet favours the end of each stage"},
    {"power_control_restarts", nullptr, &Ad7147Behaviour::power_control_restarts, 0, 1, 0, 1, "open"},
    {"shifted_after_stop", nullptr, &Ad7147Behaviour::shifted_after_stop, 0, 1, 0, 1, "seen on the AD7142"},
    {"status_needs_enable", nullptr, &Ad7147Behaviour::status_needs_enable, 0, 1, 0, 1, "open"},
    {"gain", &Ad7147Behaviour::gain, nullptr, 0.75, 1.25, 0.2, 5.0,
     "the maker's forum: the accuracy of a code may only be 20 … 25 %"},
    {"stage_memory", &Ad7147Behaviour::stage_memory, nullptr, 0.0, 0.002, 0.0, 0.5, "nobody knows"},
}};

}  // namespace triskin::hardware
