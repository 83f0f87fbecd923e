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

/// Side of a part to be taken.
enum class SideWanted : std::uint8_t {
  kAuto,   ///< The outer side is taken where it can be told, and everything where there is no wall.
  kOuter,  ///< The more likely side is taken even where it cannot be told for certain.
  kInner,  ///< The side that kOuter would leave out is taken.
  kBoth,   ///< Both sides are taken.
};
inline constexpr NameTable kSideWantedNames{
    std::array<std::pair<SideWanted, std::string_view>, 4>{{{SideWanted::kAuto, "auto"},
                                                            {SideWanted::kOuter, "outer"},
                                                            {SideWanted::kInner, "inner"},
                                                            {SideWanted::kBoth, "both"}}}};

/// Options of find_sides(). Lengths in mm.
struct SideOptions {
  SideWanted wanted = SideWanted::kAuto;
  int choice = 0;  ///< It takes side 1 or 2 of what is undecided (SideChoice::choice_of_face); 0 takes none.
  std::optional<Vec3> from_mm;  ///< The side that is seen from this point counts as the outer one.
  double min_wall_mm = 0.3;     ///< Thinner sheets are taken for one that is stored twice; it must be positive.
  double max_wall_mm = 8.0;     ///< What is thicker is a body and not a wall; it must exceed min_wall_mm.
  int threads = 2;              ///< At least 1; the result does not depend on it.
};

/// Faces that hang together over smooth edges and lie on one side of the wall.
struct SideRegion {
  FaceSide side = FaceSide::kOuter;
  double area_mm2 = 0.0;
  double walled_fraction = 0.0;  ///< It is the share of the area (0 … 1) that has another sheet behind it.
  double wall_mm = 0.0;          ///< It is the median thickness of the wall; 0 means that there is none.
  /// It is the mean share (0 … 1) of the half sphere above the region that is free, weighted by the cosine.
  double visibility = 0.0;
  double hull_depth_mm = 0.0;  ///< It is the mean distance along the normal to the convex hull.
  double outwardness = 0.0;    ///< It runs from −1, inner, to 1, outer; near 0 both sides look alike.
};

/// Result of find_sides().
struct SideChoice {
  bool has_wall = false;  ///< When it is false, every face is kOuter and nothing is left out.
  bool is_certain = true;
  bool has_loose_sheets = false;  ///< The wall is two sheets that no rim joins, so kAuto keeps both.
  int enclosed = 0;  ///< So many components lie wholly inside of another one, as a board in its cover; they are inner.
  double wall_mm = 0.0;             ///< It is the median thickness; 0 means that there is no wall.
  double margin = 1.0;              ///< 0 … 1: least |outwardness| of the regions that matter; 1 without a wall
  std::vector<int> region_of_face;  ///< Each face has the index of its region in `regions`.
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
  SideOptions options;  ///< These options were used, with what was filled in.
  SideChoice choice;
  bool is_undecided = false;  ///< Both sides look alike and nobody said which to take, so `surface` is empty.
  Mesh surface;               ///< It is the unchanged part if there is no wall or with SideWanted::kBoth.
  double part_mm2 = 0.0, taken_mm2 = 0.0;
  double undecided_mm2 = 0.0;  ///< This area was left out because its two sides look alike; it counts both of them.
  int rim_faces = 0;           ///< Faces between the two sides were left out.
};

/// What was taken, as design files and results name it: outer, inner, both, 1, 2, from (the side that is seen from a
/// point), undecided, or whole where there is no wall.
[[nodiscard]] std::string side_name(const TakenSide& taken);

/// Takes one side of a part (docs/side.md). Components of the result that are smaller than a module are dropped.
/// Errors: as find_sides(); InputError naming the remedy when no surface as large as a module is left. Cost:
/// find_sides().
[[nodiscard]] TakenSide take_side(const Mesh& part, const SideOptions& options = {});

}  // namespace triskin::geometry
