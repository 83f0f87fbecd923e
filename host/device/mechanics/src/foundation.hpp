// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Computes a contact on columns: the displacement is δ − gap inside the contact and nothing outside, and `law`
/// turns a displacement in mm into a pressure in kPa. The caller has found `indentation_mm`.
[[nodiscard]] Contact foundation_contact(const Indenter& indenter, double force, double indentation_mm,
                                         std::function<double(double)> law);

/// Returns the radius, or half width, at which the gap of the indenter is `indentation_mm`; for a punch its own radius.
[[nodiscard]] double foundation_radius_mm(const Indenter& indenter, double indentation_mm);

/// Returns the gap of the indenter above its lowest point at a distance inside its contact, mm.
[[nodiscard]] double gap_mm(const Indenter& indenter, double distance_mm);

}  // namespace triskin::mechanics
