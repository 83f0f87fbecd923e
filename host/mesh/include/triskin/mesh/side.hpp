// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Position of a face on a part with a wall.
enum class FaceSide : std::uint8_t {
  kOuter,      ///< on the side that the skin goes on, or on a surface that has no wall
  kInner,      ///< behind the wall, or hidden inside the part
  kRim,        ///< between both: the edge of the wall, of a hole, of a step
  kUndecided,  ///< on one of two sides that look alike
};
inline constexpr NameTable kFaceSideNames{
    std::array<std::pair<FaceSide, std::string_view>, 4>{{{FaceSide::kOuter, "outer"},
                                                          {FaceSide::kInner, "inner"},
                                                          {FaceSide::kRim, "rim"},
                                                          {FaceSide::kUndecided, "undecided"}}}};

/// Side of a part to be taken.
enum class SideWanted : std::uint8_t {
  kAuto,   ///< the outer side where it can be told, everything where there is no wall
  kOuter,  ///< the more likely side, also where it cannot be told
  kInner,  ///< the other one
  kBoth,   ///< everything
};
inline constexpr NameTable kSideWantedNames{
    std::array<std::pair<SideWanted, std::string_view>, 4>{{{SideWanted::kAuto, "auto"},
                                                            {SideWanted::kOuter, "outer"},
                                                            {SideWanted::kInner, "inner"},
                                                            {SideWanted::kBoth, "both"}}}};

/// Options of find_sides(). Lengths in mm.
struct SideOptions {
  SideWanted wanted = SideWanted::kAuto;
  int choice = 0;               ///< 1 or 2: this side of what is undecided (SideChoice::choice_of_face); 0: none
  std::optional<Vec3> from_mm;  ///< the side that is seen from this point is the outer one
  double min_wall_mm = 0.3;     ///< > 0; thinner sheets are taken for one that is stored twice
  double max_wall_mm = 8.0;     ///< > min_wall_mm; what is thicker is a body, not a wall
  int threads = 2;              ///< ≥ 1; nothing depends on it
};

/// Faces that hang together over smooth edges and lie on one side of the wall.
struct SideRegion {
  FaceSide side = FaceSide::kOuter;
  double area_mm2 = 0.0;
  double walled_fraction = 0.0;  ///< 0 … 1: share of its area that has another sheet behind it
  double wall_mm = 0.0;          ///< median thickness there; 0 without a wall
  double visibility = 0.0;       ///< 0 … 1: mean cosine-weighted share of the half sphere above it that is free
  double hull_depth_mm = 0.0;    ///< mean distance along the normal to the convex hull
  double outwardness = 0.0;      ///< −1 inner … 1 outer; near 0: both sides look alike
};

/// Result of find_sides().
struct SideChoice {
  bool has_wall = false;  ///< false: every face is kOuter, nothing is left out
  bool is_certain = true;
  bool has_loose_sheets = false;    ///< a wall of two sheets that no rim joins: kAuto keeps both
  double wall_mm = 0.0;             ///< median thickness; 0 without a wall
  double margin = 1.0;              ///< 0 … 1: least |outwardness| of the regions that matter; 1 without a wall
  std::vector<int> region_of_face;  ///< index in `regions`
  std::vector<SideRegion> regions;
  /// 1 or 2 for each face that is kUndecided: the two sides that SideOptions::choice tells apart; 0 elsewhere.
  std::vector<std::uint8_t> choice_of_face;

  [[nodiscard]] FaceSide side_of(int face) const {
    return regions[static_cast<std::size_t>(region_of_face[static_cast<std::size_t>(face)])].side;
  }
};

/// Tells the outer side of a part from its inner one (docs/side.md). The mesh is a manifold, oriented with the material
/// behind each face, as extract() leaves it. Surfaces without a wall come back as one side. Deterministic. Errors:
/// InputError for options out of range. Cost: one ray a face and about 400,000 more, O(n log n); 1 s of processor time
/// for 100,000 faces, 250 bytes a face. Thread-safe.
[[nodiscard]] SideChoice find_sides(const Mesh& mesh, const SideOptions& options = {});

/// The surface that was taken of a part, and what to say of it.
struct TakenSide {
  SideOptions options;  ///< options that were used
  SideChoice choice;
  bool is_undecided = false;  ///< both sides look alike and nobody said which; `surface` is empty
  Mesh surface;               ///< the part itself, unchanged, without a wall or with SideWanted::kBoth
  double part_mm2 = 0.0, taken_mm2 = 0.0;
  double undecided_mm2 = 0.0;  ///< area that was left out because its two sides look alike, both of them together
  int rim_faces = 0;           ///< left out between the two sides
};

/// What was taken, as design files and results name it: outer, inner, both, 1, 2, from (the side that is seen from a
/// point), undecided, or whole where there is no wall.
[[nodiscard]] std::string side_name(const TakenSide& taken);

/// Takes one side of a part (docs/side.md). Components of the result that are smaller than a module are dropped.
/// Errors: as find_sides(); InputError naming the remedy when no surface as large as a module is left. Cost:
/// find_sides().
[[nodiscard]] TakenSide take_side(const Mesh& part, const SideOptions& options = {});

}  // namespace triskin::geometry
