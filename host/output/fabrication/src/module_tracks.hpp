// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "module_board.hpp"

/// The tracks inside a module: from the chip to taxels, straps, capacitors and contacts. They are the same on every
/// module, because straps choose line and address.
namespace triskin::fabrication {

/// The copper layers of the board, from the touch side to the back.
enum class CopperLayer { kFront, kInner1, kInner2, kBack };
[[nodiscard]] const char* copper_layer_name(CopperLayer layer);

/// A straight track of kNarrowTrack_mm. It has the net of `pad`, a name of module_pads().
struct ModuleTrack {
  std::string pad;
  CopperLayer layer = CopperLayer::kBack;
  design::Vec2 from_mm, to_mm;
};

/// A plated hole through all layers, with the diameters of a contact. It has the net of `pad`.
struct ModuleVia {
  std::string pad;
  design::Vec2 at_mm;
};

struct ModuleRouting {
  std::vector<ModuleTrack> tracks;
  std::vector<ModuleVia> vias;
};

/// Returns tracks and vias that join all pads of module_pads() with equal nets, in the frame of the module. They keep
/// kClearance_mm from all other copper of the board: rings, joints and cables of any port, at corner cuts up to
/// kMaxBoardCornerCut_mm. The result is always the same. Cost: some tenths of a second at the first call, then none.
/// Errors: std::logic_error if the pads leave no room, which a test excludes.
[[nodiscard]] const ModuleRouting& module_routing();

}  // namespace triskin::fabrication
