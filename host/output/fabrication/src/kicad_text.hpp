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

/// Returns true for pads of the back that get solder paste of their own size: not straps, and not the chip's wide pad.
[[nodiscard]] bool has_paste(const ModulePad& pad);

/// Returns the ten pads of a cable in the frame of port A, named "1" … "10".
[[nodiscard]] std::vector<ModulePad> cable_pads();

/// Returns what a module has besides pads, inside a footprint: paste windows, outlines and pin-1 marks of its parts on
/// the back's silkscreen, their designators and courtyards. `turn_rad` is the angle of the footprint.
[[nodiscard]] std::string module_details(double turn_rad);

[[nodiscard]] double degrees(double angle_rad);

}  // namespace triskin::fabrication
