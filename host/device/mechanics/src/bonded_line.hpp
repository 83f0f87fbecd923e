// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Solves the line contact of press_bonded(); `force` is in N/mm.
[[nodiscard]] Contact press_bonded_line(const Layer& layer, double radius_mm, double force);

}  // namespace triskin::mechanics
