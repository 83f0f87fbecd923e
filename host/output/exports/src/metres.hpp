// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::exports {

inline constexpr double kMetres_per_mm = 1e-3;  ///< glTF, URDF and SDF use metres.

}  // namespace triskin::exports
