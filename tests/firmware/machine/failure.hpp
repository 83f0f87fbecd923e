// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "skin_line.hpp"
#include "triskin/wire/uds.hpp"

namespace triskin::machine {

/// Names the failures that a strapped module can have (docs/scene.md, Faults), as a bench makes them.
enum class Failure { kAbsent, kMoved, kWrongId, kDip, kSaturated, kFrozen, kSda, kScl };

inline constexpr std::array kAllFailures{Failure::kAbsent,    Failure::kMoved,  Failure::kWrongId, Failure::kDip,
                                         Failure::kSaturated, Failure::kFrozen, Failure::kSda,     Failure::kScl};

/// Returns the controller's state for the failed module; the module that a moved one meets is called duplicate.
[[nodiscard]] wire::ModuleState state_of(Failure failure);

[[nodiscard]] constexpr bool holds_line(Failure failure) {
  return failure == Failure::kSda || failure == Failure::kScl;
}

/// Makes module `m` of a bench with sixteen (line m % 4, address m / 4) fail on its line. A moved one gets the straps
/// of the next one.
void inject(Failure failure, SkinLine& line, int m, std::uint64_t now_us);
/// Restores the former state. A dip needs no repair, because the chip waits to be configured.
void repair(Failure failure, SkinLine& line, int m);

}  // namespace triskin::machine
