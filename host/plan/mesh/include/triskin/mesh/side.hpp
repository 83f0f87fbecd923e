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

namespace triskin::mesh {

enum class FaceSide : std::uint8_t {
  kOuter,      ///< The face is on the side that the skin goes on, or the surface has no wall.
  kInner,      ///< The face is behind the wall, or hidden inside the part.
  kRim,        ///< The face lies between both sides: the edge of the wall, of a hole, or of a step.
  kUndecided,  ///< The face is on one of two sides that look alike.
};
inline constexpr NameTable kFaceSideNames{
    std::array<std::pair<FaceSide, std::string_view>, 4>{{{FaceSide::kOuter, "outer"},
                                                          {FaceSide::kInner, "inner"},
                                                          {FaceSide::kRim, "rim"},
                                                          {FaceSide::kUndecided, "undecided"}}}};

/// Selects the side of a part that gets the skin.
enum class SideWanted : std::uint8_t {
  kAuto,   ///< The outer side is taken if it can be determined, and everything if there is no wall.
  kOuter,  ///< The more likely side is taken even if it is not certain.
  kInner,  ///< The side that kOuter would leave out is taken.
  kBoth,   ///< Both sides are taken.
};
inline constexpr NameTable kSideWantedNames{
    std::array<std::pair<SideWanted, std::string_view>, 4>{{{SideWanted::kAuto, "auto"},
                                                            {SideWanted::kOuter, "outer"},
                                                            {SideWanted::kInner, "inner"},
                                                            {SideWanted::kBoth, "both"}}}};

/// Lengths are in mm.
struct SideOptions {
  SideWanted wanted = SideWanted::kAuto;
  int choice = 0;  ///< 1 or 2 selects a side of the undecided faces (SideChoice::choice_of_face); 0 selects none.
  std::optional<Vec3> from_mm;  ///< The side that is seen from this point counts as the outer one.
  double min_wall_mm = 0.3;  ///< A thinner pair of sheets counts as one sheet that is stored twice; must be positive.
  double max_wall_mm = 8.0;  ///< A thicker part counts as a solid body without a wall; must exceed min_wall_mm.
  int threads = 2;           ///< The number must be at least 1 and does not affect the result.

  /// True if somebody asked for a side, which then follows the evidence that there is, however small the wall.
  [[nodiscard]] bool is_asked() const {
    return wanted == SideWanted::kOuter || wanted == SideWanted::kInner || choice > 0;
  }
};

/// A set of faces that are connected over smooth edges and lie on one side of the wall.
struct SideRegion {
  FaceSide side = FaceSide::kOuter;
  double area_mm2 = 0.0;
  double walled_fraction = 0.0;  ///< This fraction (0 … 1) of the area has another sheet behind it.
  double wall_mm = 0.0;          ///< The thickness is the median over the region; 0 means that there is no wall.
  /// The mean fraction (0 … 1) of the half sphere above the region that is free, weighted by the cosine.
  double visibility = 0.0;
  double hull_depth_mm = 0.0;  ///< The mean distance is measured along the normal to the convex hull.
  double outwardness = 0.0;    ///< The value runs from −1, inner, to 1, outer; near 0 both sides look alike.
};

struct SideChoice {
  bool has_wall = false;  ///< False means that every face is kOuter and nothing is left out.
  bool is_certain = true;
  bool has_loose_sheets = false;  ///< The wall consists of two sheets that no rim joins, so kAuto keeps both.
  int enclosed = 0;  ///< This many components lie wholly inside another one, as a board in its cover; they are inner.
  double wall_mm = 0.0;             ///< It is the median thickness; 0 means that there is no wall.
  double margin = 1.0;              ///< 0 … 1: least |outwardness| of the regions that matter; 1 without a wall
  std::vector<int> region_of_face;  ///< Each face has the index of its region in `regions`.
  std::vector<SideRegion> regions;
  /// An undecided face has 1 or 2, the side that selects it in SideOptions::choice; all others have 0.
  std::vector<std::uint8_t> choice_of_face;

  [[nodiscard]] FaceSide side_of(FaceIndex face) const {
    return regions[static_cast<std::size_t>(region_of_face[static_cast<std::size_t>(face)])].side;
  }
};

/// Tells the outer side of a part from its inner one (docs/mesh.md). The mesh is a manifold, oriented with the material
/// behind each face, as extract() leaves it. A surface without a wall is returned as one side. Deterministic. Errors:
/// InputError for options out of range. Cost: one ray per face and about 400,000 more, O(n log n); 1 s of processor
/// time for 100,000 faces, 250 bytes per face. Thread-safe.
[[nodiscard]] SideChoice find_sides(const Mesh& mesh, const SideOptions& options = {});

/// Holds the surface that was taken of a part, and what a report says about it.
struct TakenSide {
  SideOptions options;  ///< These options were used; take_side() filled in the values that nobody gave.
  SideChoice choice;
  bool is_undecided = false;  ///< Both sides look alike and nobody said which to take, so `surface` is empty.
  Mesh surface;               ///< The part is unchanged if there is no wall or with SideWanted::kBoth.
  double part_mm2 = 0.0, taken_mm2 = 0.0;
  double undecided_mm2 = 0.0;  ///< This area was left out because its two sides look alike; both of them are counted.
  int rim_faces = 0;           ///< These faces lie between the two sides and were left out.
};

/// Names the side in design files and results: outer, inner, both, 1, 2, from (the side that is seen from a point),
/// undecided, or whole if there is no wall.
[[nodiscard]] std::string side_name(const TakenSide& taken);

/// Takes one side of a part (docs/mesh.md) and drops components smaller than a module. Errors: as find_sides();
/// InputError naming the remedy when no surface as large as a module remains. Cost: find_sides().
[[nodiscard]] TakenSide take_side(const Mesh& part, const SideOptions& options = {});

}  // namespace triskin::mesh
