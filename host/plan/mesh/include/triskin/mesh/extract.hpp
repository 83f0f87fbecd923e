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

namespace triskin::mesh {

/// Connected faces of the input that are not in the surface: small, hidden or enclosed ones, fins at edges with more
/// than two faces.
struct DroppedPart {
  double area_mm2 = 0.0;         ///< Of faces that are there in part, what is missing.
  Vec3 where_mm = Vec3::Zero();  ///< middle of its largest face
  int faces = 0;
};

/// Tells how far a repaired surface is from its input: from every point of the input that is in no dropped part to the
/// surface, and from all of the surface to the input.
struct Deviation {
  double mean_mm = 0.0;     ///< The mean is taken over the area, in the direction that gives the larger value.
  double largest_mm = 0.0;  ///< This is a proved bound: no point is farther away.
  /// A point at this distance was found; the bound exceeds it by at most 0.02 mm unless time or parts ran out.
  double found_mm = 0.0;
  Vec3 where_mm = Vec3::Zero();  ///< The largest distance was found at this point.
};

/// Tells how extract() made a surface that design() accepts; the values are in the order of trying.
enum class Repair : std::uint8_t {
  kNone,
  /// Faces that cross were divided along their common lines and hidden parts dropped; the other faces are unchanged.
  kLocal,
  kWrap,  ///< CGAL's alpha wrap replaced the mesh.
  kGrid,  ///< The surface of a grid around the input replaced the mesh.
};
/// The command line prints these names.
inline constexpr NameTable kRepairNames{std::array<std::pair<Repair, std::string_view>, 4>{
    {{Repair::kNone, "none"}, {Repair::kLocal, "local"}, {Repair::kWrap, "wrap"}, {Repair::kGrid, "grid"}}}};

/// Lists what extract() changed in a raw mesh, as counts unless the name says otherwise.
struct ExtractReport {
  int removed_components = 0;  ///< These parts were small or hidden.
  int removed_faces = 0;       ///< These faces were hidden, or at edges with more than two faces.
  /// Every point of the mesh farther from the surface than the deviation lies in one of these.
  std::vector<DroppedPart> dropped;
  int flipped_faces = 0;  ///< These faces were turned so that neighbours agree.
  int boundary_loops = 0;
  int non_manifold_edges = 0;  ///< These edges of the raw mesh have more than two faces.
  int components = 0;          ///< The result has this many connected parts.
  /// These parts lay in a closed part and were dropped in addition to removed_components; this needs
  /// ExtractOptions::repair, and `outer` other than kNever.
  int enclosed_components = 0;
  bool outer = false, wrapped = false;  ///< True means that this optional step was taken.
  double kept_out_mm2 = 0.0;            ///< The keep-outs took away this area.
  Repair repair = Repair::kNone;        ///< Only ExtractOptions::repair allows another value.
  /// This many pairs of faces of the raw or reduced mesh pass through each other; without a repair nobody counts them.
  int crossings = 0;
  /// All values are 0 if nothing was repaired or reduced. Measured before the keep-outs are cut.
  Deviation deviation;
  /// A mesh with more faces than the repair has time for is reduced first, by at most this distance; `deviation`
  /// includes it. Zero means that the mesh was not reduced.
  double reduced_mm = 0.0;
  /// This fraction of the faces was tested for crossings. Below 1 the time ran out, and other faces may cross.
  double tested = 1.0;
};

/// No module may cover any point of this ball. The radius must be positive.
struct KeepOutSphere {
  Vec3 center_mm;
  double radius_mm;
};
/// The box follows the axes of the mesh frame, with low ≤ high on each.
struct KeepOutBox {
  Vec3 low_mm, high_mm;
};

/// Selects the steps beyond repair. All lengths must be positive.
struct ExtractOptions {
  /// kWhenNeeded takes a step only if the mesh has the fault that the step removes.
  enum class When { kNever, kWhenNeeded, kAlways };
  bool repair = false;       ///< The result then passes usable() whatever the input was, and closed parts face outward.
  bool keep_usable = false;  ///< If usable() accepts the mesh, `repair` is the only step taken.
  double repair_s = 60.0;    ///< The repair aims to finish in this time (> 0) and falls back to a coarser one.
  /// Returns seconds from any start, for `repair_s`. An empty function selects the steady clock of this computer; a
  /// clock that stands still makes the result independent of the load.
  std::function<double()> clock_s{};
  /// Drops what sees little of the sky. The step is needed with several large parts or edges with more than two faces.
  /// With `repair` it also drops what lies in a closed part, unless kNever.
  When outer = When::kNever;
  /// A face is outside if at least this fraction of the half sphere above it is free (0 … 1, weighted by the cosine).
  double visibility_fraction = 0.25;
  /// Shrink-wraps the mesh first. The step is needed if the remaining mesh crosses itself or is shattered.
  When wrap = When::kNever;
  double wrap_alpha_mm = 6.0;   ///< Openings narrower than this are closed.
  double wrap_offset_mm = 0.2;  ///< The wrap lies this far outside the mesh.
  std::vector<KeepOutSphere> spheres;
  std::vector<KeepOutBox> boxes;
  /// The mesh must be closed and face outward; its inside and everything nearer to it than the margin stay free of
  /// modules.
  std::optional<Mesh> keep_out;
  double keep_out_margin_mm = 0.0;
};

struct Extraction {
  Mesh surface;  ///< The surface is manifold, and oriented outwards if an outer side can be determined.
  ExtractReport report;
};

/// Makes a manifold, consistently oriented surface of a welded mesh: drops faces beyond two at an edge (those that turn
/// most), orients each component over its edges (cutting a Möbius band), splits pinched vertices, and drops components
/// smaller than a module. Errors: InputError when nothing remains. Cost: O(n log n). Thread-safe.
[[nodiscard]] Extraction extract(const Mesh& mesh, const ProgressSink& progress = {});

/// Takes the optional steps as well. Faces at a keep-out are divided down to 1.5 mm, so that the cut follows its
/// outline from outside by less than that; no remaining point lies in a keep-out. Sharp edges stay as they are (except
/// when wrapped). Errors: InputError when nothing remains, naming the step that removed it. Cost: as above; `outer` 128
/// rays per face on all cores, `wrap` seconds (CGAL alpha wrap: Portaneri et al., 2022).
[[nodiscard]] Extraction extract(const Mesh& mesh, const ExtractOptions& options, const ProgressSink& progress = {});

/// Applies the test of design(): writing and reading leave the mesh unchanged, it is an oriented manifold with a part
/// as large as a module, and no two of its faces pass through or touch each other beyond a common edge or corner. Every
/// result of extract() with `repair` passes. Cost: O(n log n) typical.
[[nodiscard]] bool usable(const Mesh& mesh);

/// Checks that no edge of the mesh has more than two faces. Errors: InputError naming `name` and the place otherwise.
/// Cost: O(n log n).
void require_manifold(const Mesh& mesh, const std::string& name);

/// Checks with exact predicates that no two faces of the surface pass through each other. Errors: InputError naming
/// `name` and the place otherwise. Cost: O(n log n) typical.
void require_no_self_intersection(const Mesh& surface, const std::string& name);

}  // namespace triskin::mesh
