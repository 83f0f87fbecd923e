// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/geometry/routing.hpp"
#include "triskin/model/module_list.hpp"

namespace triskin::model {

/// Picture of a routed module list in its lattice (SVG, islands side by side): modules coloured by line and labelled
/// with their address, patches outlined, arrows from parent to child, a dot where the cable enters, a ring at a second
/// entry.
[[nodiscard]] std::string route_svg(const ModuleList& list, const geometry::RoutingResult& result);

}  // namespace triskin::model
