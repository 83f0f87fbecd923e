// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string_view>

#include "triskin/hardware/ad7147.hpp"

namespace triskin::machine {

/// Names one way to read the data sheet of the converter where it is ambiguous (docs/silicon.md).
struct NamedBehaviour {
  std::string_view name;
  hardware::Ad7147Behaviour chip;
};
inline constexpr std::array<NamedBehaviour, 5> kBehaviours{{
    {"ConvReset", {}},
    {"PowerRestarts", {.power_control_restarts = true}},
    {"Shifted", {.shifted_after_stop = true}},
    {"LatchedAtEnd", {.latched_at_end = true}},
    {"AllAtOnce", {.shifted_after_stop = true, .latched_at_end = true, .step_counts = 0.36 * hardware::kCountsPerPf}},
}};

/// Returns the behaviour of that name, or the first one if there is none.
[[nodiscard]] constexpr const hardware::Ad7147Behaviour& behaviour_named(std::string_view name) {
  for (const NamedBehaviour& b : kBehaviours) {
    if (b.name == name) return b.chip;
  }
  return kBehaviours[0].chip;
}

}  // namespace triskin::machine
