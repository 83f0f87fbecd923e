// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "checked_design.hpp"

namespace triskin::check {

/// Returns by how much two modules overlap, in mm, whatever the angle between them (docs/limits.md, penetration_mm);
/// `cut` is their corner cut in mm.
[[nodiscard]] double module_overlap(const Triangle3& a, const Triangle3& b, double cut);

}  // namespace triskin::check
