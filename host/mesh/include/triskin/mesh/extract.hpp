// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// How far a repaired surface is from the outside of its input: from the faces of the input that see the share
/// `visibility_fraction` of the sky to the surface, and from all of the surface to the input.
struct Deviation {
  double mean_mm = 0.0;     ///< mean over the area, in the direction in which it is larger
  double largest_mm = 0.0;  ///< no point is farther: a proved bound
  double found_mm = 0.0;    ///< largest distance found, ≤ largest_mm; 0.02 mm below it unless time or parts ran out
  Vec3 where_mm = Vec3::Zero();  ///< place of the largest distance found
};

/// What extract() did to make a surface that design() takes, in the order in which it is tried.
enum class Repair : std::uint8_t {
  kNone,   ///< nothing: it was one
  kLocal,  ///< faces that cross were divided along their common lines, hidden parts dropped; the others are as they
           ///< were
  kWrap,   ///< shrink-wrapped
  kGrid,   ///< surface of a grid around the input
};
/// Names in the output of the command line.
inline constexpr NameTable kRepairNames{std::array<std::pair<Repair, std::string_view>, 4>{
    {{Repair::kNone, "none"}, {Repair::kLocal, "local"}, {Repair::kWrap, "wrap"}, {Repair::kGrid, "grid"}}}};

/// Changes that extract() made to a raw mesh, as counts unless the name says otherwise.
struct ExtractReport {
  int removed_components = 0;           ///< small or hidden parts
  int removed_faces = 0;                ///< faces at edges with more than two faces, hidden faces
  int flipped_faces = 0;                ///< faces turned so that neighbours agree
  int boundary_loops = 0;               ///< borders of the result
  int non_manifold_edges = 0;           ///< edges of the raw mesh with more than two faces
  int components = 0;                   ///< connected parts that are left
  int enclosed_components = 0;          ///< parts in a closed part, dropped (beside removed_components); only with
                                        ///< ExtractOptions::repair, and `outer` not kNever
  bool outer = false, wrapped = false;  ///< steps on demand that were taken
  double kept_out_mm2 = 0.0;            ///< area that the keep-outs took
  Repair repair = Repair::kNone;        ///< the repair that was needed; only with ExtractOptions::repair
  int crossings = 0;        ///< pairs of faces of the raw or reduced mesh that pass through each other; likewise
  Deviation deviation;      ///< deviation of the repair; 0 with Repair::kNone and nothing reduced, before keep-outs
  double reduced_mm = 0.0;  ///< a mesh with more faces than the time of the repair is worth was reduced first, by no
                            ///< more than this, which the deviation has in it; 0: it was not
  double tested = 1.0;      ///< share of the faces that were tested for crossing others: less, the time was over and
                            ///< others may cross
};

/// Ball that no module may cover; radius > 0.
struct KeepOutSphere {
  Vec3 center_mm;
  double radius_mm;
};
/// Box along the axes of the mesh frame; low ≤ high on each.
struct KeepOutBox {
  Vec3 low_mm, high_mm;
};

/// Steps beyond repair. Lengths > 0 mm.
struct ExtractOptions {
  /// When a step is taken.
  enum class When { kNever, kWhenNeeded, kAlways };
  bool repair = false;       ///< the result is one that usable() accepts, whatever the input; closed parts face outward
  bool keep_usable = false;  ///< a mesh that usable() accepts takes no step other than `repair`
  double repair_s = 60.0;    ///< > 0: time of the repair; if it does not suffice, a coarser one is used
  std::function<double()> clock_s{};  ///< seconds, from any start, for `repair_s`; none: the steady clock of this
                                      ///< computer. One that stands still makes the result independent of the load
  When outer = When::kNever;  ///< drop what sees little of the sky; needed: several large parts, or edges with more
                              ///< than two faces. With `repair` also what lies in a closed part, unless kNever
  double visibility_fraction =
      0.25;                     ///< 0 … 1: cosine-weighted share of the half sphere above a face that must be free
  When wrap = When::kNever;     ///< shrink-wrap first; needed: what is left crosses itself, or is shattered
  double wrap_alpha_mm = 6.0;   ///< openings narrower than this are closed
  double wrap_offset_mm = 0.2;  ///< the wrap lies this far outside
  std::vector<KeepOutSphere> spheres;
  std::vector<KeepOutBox> boxes;
  std::optional<Mesh> keep_out;  ///< closed, outward: its inside, and what is nearer to it than the margin
  double keep_out_margin_mm = 0.0;
};

/// Result of extract().
struct Extraction {
  Mesh surface;  ///< manifold, oriented outwards where a side can be told
  ExtractReport report;
};

/// Makes a manifold, consistently oriented surface of a welded mesh: drops faces beyond two at an edge (the ones that
/// turn most), orients each component over its edges (a Möbius band is cut), splits pinched vertices, and drops
/// components smaller than a module. Errors: InputError when nothing is left. Cost: O(n log n). Thread-safe.
[[nodiscard]] Extraction extract(const Mesh& mesh, const ProgressSink& progress = {});

/// The same with the steps beyond repair. Faces at a keep-out are divided down to 1.5 mm, so that its outline is
/// followed from outside by less than that; no point that stays lies in a keep-out. Sharp edges stay as they are
/// (except when wrapped). Errors: InputError when nothing is left, naming
/// the step that took it. Cost: as above; `outer` 128 rays a face on all cores, `wrap` seconds (CGAL alpha wrap:
/// Portaneri et al., 2022).
[[nodiscard]] Extraction extract(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress = {});

/// The test of design(): the mesh stays as it is when it is written and read, is an oriented manifold with a part as
/// large as a module, and no two of its faces pass through or touch each other beyond a common edge or corner. What
/// extract() gives with `repair` passes. Cost: O(n log n) typical.
[[nodiscard]] bool usable(const Mesh& mesh);

/// Checks that no edge of the mesh has more than two faces. Errors: InputError naming `name` and the place otherwise.
/// Cost: O(n log n).
void require_manifold(const Mesh& mesh, const std::string& name);

/// Checks with exact predicates that no two faces of the surface pass through each other. Errors: InputError naming
/// `name` and the place otherwise. Cost: O(n log n) typical.
void require_no_self_intersection(const Mesh& surface, const std::string& name);

}  // namespace triskin::geometry
