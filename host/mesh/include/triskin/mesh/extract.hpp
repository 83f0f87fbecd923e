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
  double mean_mm = 0.0;     ///< The mean is taken over the area, in the direction in which it is larger.
  double largest_mm = 0.0;  ///< No point is farther away: this is a proved bound.
  double found_mm = 0.0;    ///< It is the largest distance found, 0.02 mm below the bound unless time or parts ran out.
  Vec3 where_mm = Vec3::Zero();  ///< The largest distance was found here.
};

/// What extract() did to make a surface that design() takes, in the order in which it is tried.
enum class Repair : std::uint8_t {
  kNone,   ///< No repair was needed.
  kLocal,  ///< Faces that cross were divided along their common lines and hidden parts dropped; the other faces stay.
  kWrap,   ///< The mesh was shrink-wrapped.
  kGrid,   ///< The surface of a grid around the input was taken.
};
/// Names in the output of the command line.
inline constexpr NameTable kRepairNames{std::array<std::pair<Repair, std::string_view>, 4>{
    {{Repair::kNone, "none"}, {Repair::kLocal, "local"}, {Repair::kWrap, "wrap"}, {Repair::kGrid, "grid"}}}};

/// Changes that extract() made to a raw mesh, as counts unless the name says otherwise.
struct ExtractReport {
  int removed_components = 0;           ///< It counts parts that were small or hidden.
  int removed_faces = 0;                ///< It counts faces at edges with more than two faces, and hidden faces.
  int flipped_faces = 0;                ///< It counts faces that were turned so that neighbours agree.
  int boundary_loops = 0;               ///< It counts the borders of the result.
  int non_manifold_edges = 0;           ///< It counts the edges of the raw mesh that have more than two faces.
  int components = 0;                   ///< It counts the connected parts that are left.
  int enclosed_components = 0;          ///< parts in a closed part, dropped (beside removed_components); only with
                                        ///< ExtractOptions::repair, and `outer` not kNever
  bool outer = false, wrapped = false;  ///< They say which of the optional steps were taken.
  double kept_out_mm2 = 0.0;            ///< The keep-outs took this area.
  Repair repair = Repair::kNone;        ///< A repair happens only with ExtractOptions::repair.
  /// It counts pairs of faces of the raw or reduced mesh that pass through each other; a repair counts them too.
  int crossings = 0;
  Deviation deviation;      ///< It is 0 where nothing was repaired or reduced, and is taken before the keep-outs.
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
  bool repair = false;       ///< The result then passes usable() whatever the input was, and closed parts face outward.
  bool keep_usable = false;  ///< A mesh that usable() accepts then takes no step other than `repair`.
  double repair_s = 60.0;    ///< The repair may take so long (> 0); if that does not suffice, a coarser one is used.
  std::function<double()> clock_s{};  ///< seconds, from any start, for `repair_s`; none: the steady clock of this
                                      ///< computer. One that stands still makes the result independent of the load
  When outer = When::kNever;  ///< drop what sees little of the sky; needed: several large parts, or edges with more
                              ///< than two faces. With `repair` also what lies in a closed part, unless kNever
  double visibility_fraction =
      0.25;  ///< A face is outside if so much of the half sphere above it is free (0 … 1, weighted by the cosine).
  When wrap = When::kNever;     ///< shrink-wrap first; needed: what is left crosses itself, or is shattered
  double wrap_alpha_mm = 6.0;   ///< Openings narrower than this are closed.
  double wrap_offset_mm = 0.2;  ///< The wrap lies this far outside the mesh.
  std::vector<KeepOutSphere> spheres;
  std::vector<KeepOutBox> boxes;
  /// It is closed and faces outward; its inside and what is nearer to it than the margin are kept free.
  std::optional<Mesh> keep_out;
  double keep_out_margin_mm = 0.0;
};

/// Result of extract().
struct Extraction {
  Mesh surface;  ///< It is manifold, and oriented outwards where a side can be told.
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
