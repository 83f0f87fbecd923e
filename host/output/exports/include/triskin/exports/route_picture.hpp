// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>

#include "triskin/design/module_list.hpp"
#include "triskin/design/patch.hpp"

namespace triskin::exports {

/// Draws a routed module list in its lattice (SVG, islands side by side): modules coloured by line and labelled with
/// their address, patches outlined, arrows from parent to child, a dot at the entry of the cable, a ring at a second
/// entry. `patches` must name nodes of `list`. Cost: O(modules).
[[nodiscard]] std::string route_svg(const design::ModuleList& list, std::span<const design::Patch> patches);

}  // namespace triskin::exports
