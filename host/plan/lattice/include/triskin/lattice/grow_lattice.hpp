// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {

/// With SurfaceLatticeOptions::front, measuring the other layouts may exceed the time limit by this share.
inline constexpr double kFrontTimeShare = 0.05;
/// grow_front() returns about this many layouts at most.
inline constexpr int kMaxFront = 27;

/// Sets the effort of grow_lattice(), and what it maximises: worth of the modules (their number without regions) +
/// hinge_reward · joints − price. The price is relaxed: islands that jumpers can join count n / 16 + 15 / 32
/// controllers together, and jumpers as the wiring does (docs/pipeline.md). Errors: InputError for a value out of
/// range.
struct SurfaceLatticeOptions {
  /// The limit must be positive. Once a module is found, the search stops within about 0.1 s of it.
  double time_limit_s = 20.0;
  /// If positive, each chain stops after this many ruin-and-recreate steps, as well as at the time limit.
  int iterations = 0;
  std::uint64_t seed = 1;
  /// 1 … 256 chains; the result depends on the number. If each has room for 90 modules they change one layout
  /// together, each in a zone; otherwise each has its own, and they exchange the best.
  int threads = 2;
  Price price;                 ///< Each component is 0 … 16 modules.
  double hinge_reward = 0.05;  ///< A joint is worth this much, 0 … 16 modules.
  bool front = true;           ///< True makes grow_front() also return layouts with other numbers of modules.
  /// Corners may stand off a convex surface by this much (≥ 0), so that the gap under the centre stays within its
  /// limit.
  double corner_lift_mm = 1.5;
  /// This length is cut off along each side from every corner, 0 … design::kMaxCornerCut_mm; the limits on overlap
  /// and border then apply to the cut outline.
  double corner_cut_mm = 0.0;
  /// Regions of this surface (values, places that stay free, places that must be covered), not owned; null makes every
  /// place worth 1 module.
  const mesh::SurfaceRegions* regions = nullptr;
  /// Decimated mesh of this surface, not owned. The search works on it and keeps the limits less its deviation; the
  /// layouts are measured on the surface itself. With null the search works on the surface.
  const mesh::DecimatedMesh* solver = nullptr;
  /// These modules stay exactly where they are, with the joints among them, and become the first modules of every
  /// layout, in this order. They must keep the limits and have the corner cut of the others.
  std::vector<PlacedModule> kept;
  /// Called once with the best layout of the first starts, on the calling thread, if no `iterations` are given. The
  /// answer is the time limit that applies from then on, in s from the start, so that a caller can measure on this
  /// layout what it will do afterwards. An empty function leaves time_limit_s as it is.
  std::function<double(const ModuleLayout&)> first_layout{};
  /// Measures the time limit and is called from all threads at once; an empty function selects the steady clock.
  std::function<std::chrono::steady_clock::time_point()> now{};
};

/// Grows the isometric lattice directly on the surface (docs/lattice.md): triangles are added edge by edge, their
/// shared corners slide on the surface until every rigid module keeps the limits; remaining gaps are filled with
/// further islands; then parts are removed and regrown as long as time permits. Every module of the result keeps every
/// limit, measured by `measure` (map_modules.hpp). Deterministic for seed, threads and iterations when the time
/// suffices. Empty when no module fits. Errors: InputError when an option or limit is out of range. Uses
/// options.threads threads; thread-safe. Cost: time_limit_s, or less if `iterations` ends it sooner.
[[nodiscard]] ModuleLayout grow_lattice(const mesh::Surface& surface, const LayoutLimits& limits,
                                        const SurfaceLatticeOptions& options = {}, const ProgressSink& progress = {});

/// Returns the best layout, then up to five made from it with fewer islands, and the best ones found with more modules
/// and with up to twelve fewer. Only wiring tells which of them has the highest value. Cost: about 0.1 s per further
/// layout.
[[nodiscard]] std::vector<ModuleLayout> grow_front(const mesh::Surface& surface, const LayoutLimits& limits,
                                                   const SurfaceLatticeOptions& options = {},
                                                   const ProgressSink& progress = {});

/// Explains why no module lies within `within_mm` of a place of the surface: the limit that refuses most of the modules
/// tried there (name as in design files), "keep_out", or "room" if one fits only without neighbours. Cost: about 0.1 s.
[[nodiscard]] std::string why_uncovered(const mesh::Surface& surface, const LayoutLimits& limits,
                                        const SurfaceLatticeOptions& options, const Vec3& place_mm, double within_mm);

/// Returns how far corners of the net may stand off a convex surface under these limits, in mm.
[[nodiscard]] double corner_lift_of(const LayoutLimits& limits, const SurfaceLatticeOptions& options);

}  // namespace triskin::lattice
