// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "module_board.hpp"

namespace triskin::fabrication {

inline constexpr const char* kModuleName = "Module";
inline constexpr const char* kCableName = "Cable_10";

/// Writes a pad inside a footprint that is turned by `turn_rad`; KiCad's y runs downwards, and the angle of a pad in a
/// board includes that of its footprint. `net` is its element, or empty.
[[nodiscard]] std::string pad_text(const ModulePad& pad, double turn_rad, const std::string& net);

/// Returns the ten pads of a cable in the frame of port A, named "1" … "10".
[[nodiscard]] std::vector<ModulePad> cable_pads();

[[nodiscard]] double degrees(double angle_rad);

}  // namespace triskin::fabrication
