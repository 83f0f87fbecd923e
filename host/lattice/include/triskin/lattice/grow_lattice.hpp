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

namespace triskin::geometry {

/// With SurfaceLatticeOptions::front, measuring the other layouts may exceed the time limit by this share.
inline constexpr double kFrontTimeShare = 0.05;
/// grow_front() returns about so many layouts at most.
inline constexpr int kMaxFront = 27;

/// Effort of grow_lattice(), and what it maximises: worth of the modules (their number without regions) + hinge_reward
/// · joints − price, where the price is relaxed: islands that jumpers can join count n / 16 + 15 / 32 controllers
/// together, and jumpers as the wiring does (docs/cost.md). Out of range: InputError.
struct SurfaceLatticeOptions {
  /// It must be positive; the search stops within about 0.1 s of it once a module is found.
  double time_limit_s = 20.0;
  /// If positive, each chain stops after so many ruin-and-recreate steps, as well as at the time limit.
  int iterations = 0;
  std::uint64_t seed = 1;
  /// 1 … 256 chains, part of what a result depends on. Where each has room for 90 modules they change one layout
  /// together, each in a zone; else each has its own, and they exchange the best.
  int threads = 2;
  Price price;                  ///< Each component is 0 … 16 modules.
  double hinge_reward = 0.05;   ///< A joint is worth so much, 0 … 16 modules.
  bool front = true;            ///< Then grow_front() also returns layouts with other numbers of modules.
  double corner_lift_mm = 1.5;  ///< ≥ 0: how far corners may stand off a convex surface, so that the gap under the
                                ///< centre stays in its limit
  /// Cut off along each side from every corner, 0 … design::kMaxCornerCut_mm; the limits on overlap and border then
  /// apply to the cut outline.
  double corner_cut_mm = 0.0;
  /// Regions of this surface (values, places that stay free, places that must be covered), not owned; null: every place
  /// is worth 1 module.
  const SurfaceRegions* regions = nullptr;
  /// Decimated mesh of this surface, not owned. The search works on it and keeps the limits less its deviation; the
  /// layouts are measured on the surface itself. Null: the search works on the surface.
  const DecimatedMesh* solver = nullptr;
  /// Modules that stay exactly where they are, with the joints among them: the first modules of every layout, in this
  /// order. They must keep the limits and have the corner cut of the others.
  std::vector<PlacedModule> kept;
  /// Called once with the best layout of the first starts, on the calling thread, while no `iterations` are given: a
  /// caller that measures with it what it does afterwards answers with the time limit that holds from now on, in s from
  /// the start. None, or no module found: time_limit_s holds.
  std::function<double(const ModuleLayout&)> first_layout{};
  /// What the time limit is measured by, asked from all threads at once; none: the steady clock.
  std::function<std::chrono::steady_clock::time_point()> now{};
};

/// Grows the isometric lattice directly on the surface (docs/lattice.md): triangles are added edge by edge, their
/// shared corners slide on the surface until every rigid module keeps the limits; remaining gaps are filled with
/// further islands; then parts are removed and regrown as long as time permits. Every module of the result keeps every
/// limit, measured by `measure` (map_modules.hpp). Deterministic for seed, threads and iterations when the time
/// suffices. Empty when no module fits. Errors: InputError when an option or limit is out of range. Uses
/// options.threads threads; thread-safe. Cost: time_limit_s, less where `iterations` ends it sooner.
[[nodiscard]] ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits,
                                        const SurfaceLatticeOptions& options = {}, const ProgressSink& progress = {});

/// The same; the best layout, after it up to five made of it with fewer islands, and the best found with more modules
/// and with up to twelve fewer. Which of them has the highest value is known only when they are wired. Cost: about
/// 0.1 s a layout more.
[[nodiscard]] std::vector<ModuleLayout> grow_front(const Surface& surface, const LayoutLimits& limits,
                                                   const SurfaceLatticeOptions& options = {},
                                                   const ProgressSink& progress = {});

/// Why no module lies within `within_mm` of a place of the surface: the limit that refuses most of the modules that
/// would (name as in design files), "keep_out", or "room" where one fits that has no others beside it. Cost: about
/// 0.1 s.
[[nodiscard]] std::string why_uncovered(const Surface& surface, const LayoutLimits& limits,
                                        const SurfaceLatticeOptions& options, const Vec3& place_mm, double within_mm);

/// How far corners of the net may stand off a convex surface under these limits, mm.
[[nodiscard]] double corner_lift_of(const LayoutLimits& limits, const SurfaceLatticeOptions& options);

}  // namespace triskin::geometry
