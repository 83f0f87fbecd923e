// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Returns the relative change of capacitance of a disc electrode under a contact: the mean over the disc of h / (h −
/// u), minus 1. Plates are parallel and the fringe field is neglected. `distance_mm` is that of the disc's centre from
/// the axis, or from the line. Cost: some 50 evaluations of the displacement. Thread-safe.
[[nodiscard]] double taxel_dc_over_c(const Layer& layer, const Contact& contact, double distance_mm,
                                     double disc_diameter_mm = 4.0);

/// Returns the mean displacement over the same disc, in mm.
[[nodiscard]] double taxel_displacement_mm(const Contact& contact, double distance_mm, double disc_diameter_mm = 4.0);

}  // namespace triskin::mechanics
