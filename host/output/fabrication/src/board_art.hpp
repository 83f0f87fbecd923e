// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "module_board.hpp"
#include "module_tracks.hpp"
#include "ring.hpp"
#include "triskin/sheet/sides.hpp"

/// The copper of an island's board, before it becomes a file of KiCad or Gerber files.
namespace triskin::fabrication {

/// Where something lies: turned counter-clockwise by the angle, seen from the touch side, then moved.
struct Pose {
  design::Vec2 center_mm{0, 0};
  double angle_rad = 0.0;
  [[nodiscard]] design::Vec2 operator*(const design::Vec2& p) const { return center_mm + rotated(p, angle_rad); }
  [[nodiscard]] Pose operator*(const Pose& p) const { return {*this * p.center_mm, angle_rad + p.angle_rad}; }
};

/// A module, or the pads of a cable.
struct ArtFootprint {
  const char* name = "";  ///< kModuleName or kCableName
  std::string reference;
  Pose pose;
  std::vector<std::pair<ModulePad, std::string>> pads;  ///< each with its net, empty if it has none
};
struct ArtTrack {
  design::Vec2 from_mm, to_mm;
  double width_mm = 0.0;
  CopperLayer layer = CopperLayer::kBack;
  std::string net;
};
struct ArtVia {
  design::Vec2 at_mm;
  std::string net;
};
/// Filled copper on the first inner layer.
struct ArtPlane {
  Ring ring_mm;
  std::string net;
};
struct BoardArt {
  std::vector<ArtFootprint> footprints;
  std::vector<ArtTrack> tracks;
  std::vector<ArtVia> vias;
  std::vector<ArtPlane> planes;
};

/// Returns the copper of an island in its frame: a footprint for each module and each cable, rings, tracks, shield
/// planes and closed straps. Errors: InputError for a corner cut above kMaxBoardCornerCut_mm. Cost: linear.
[[nodiscard]] BoardArt board_art(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island);

}  // namespace triskin::fabrication
