// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>

#include "triskin/check/design_rules.hpp"

namespace triskin::check {

/// States the capacities for which the routes were made: modules per patch, lines per patch, addresses per line.
struct RoutingLimits {
  int capacity = 16;
  int lines = 4;
  int addresses = 4;
};

/// Checks the output of `triskin route MODULES -o ROUTES` against the module list, by code that shares nothing with the
/// solver: every module in one connected patch of at most `capacity`, one tree over real joints towards the entry's
/// cable, input ports, (line, address) unique and within the limits, joints kept or cut, the loss under every single
/// failure by its own search, backup trees and adoptions that exist and collide nowhere, stated totals, bound not below
/// the size bound. Modules are named by id. Errors: InputError when either document lacks a key or holds another type.
/// Thread-safe. Cost: O(failures · patch size) per patch.
[[nodiscard]] DesignReport check_routes(const nlohmann::json& modules, const nlohmann::json& routes,
                                        const RoutingLimits& limits = {});

}  // namespace triskin::check
