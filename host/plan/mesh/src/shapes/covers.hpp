// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "sheet.hpp"

namespace triskin::mesh {

/// Makes a half shell around a bent, tapering axis, like the outer cover of a forearm: 300 mm long, radius 62 → 42
/// mm.
[[nodiscard]] Mesh forearm(int faces);
/// Makes the dome of a chest around two swellings: open below, at the neck and at both arms, with a hole for a
/// connector.
[[nodiscard]] Sheet torso();
/// Makes the front of a pelvis, a saddle between two wings: cut out for both legs, with a hole for a connector.
[[nodiscard]] Sheet hip();
/// Makes a tube around a bent axis, barrel-shaped, with a crest of 9 mm radius, a hole, and a flare at the knee that
/// ends in a lip folded inwards by more than 45°.
[[nodiscard]] Sheet thigh();

}  // namespace triskin::mesh
