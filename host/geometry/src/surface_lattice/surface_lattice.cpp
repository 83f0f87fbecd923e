// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/surface_lattice.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <mutex>
#include <optional>
#include <thread>

#include "grower.hpp"
#include "triskin/geometry/map_modules.hpp"

namespace triskin::geometry {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<double> running_area(const Surface& surface) {
  std::vector<double> sums;
  double sum = 0.0;
  for (const auto& f : surface.mesh().faces) {
    const auto& v = surface.mesh().vertices;
    const auto p = [&](std::size_t k) -> const Vec3& { return v[static_cast<std::size_t>(f[k])]; };
    sum += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
    sums.push_back(sum);
  }
  return sums;
}

// The best layout of all chains; among equals the one of the lowest chain, so that timing does not matter.
class Best {
 public:
  Best(double island_cost, const ProgressSink& progress) : island_cost_(island_cost), progress_(progress) {}

  void offer(int chain, const Grower& g) {
    const double value = g.score(island_cost_);
    const std::lock_guard lock(mutex_);
    if (value < score_ || (value == score_ && chain >= chain_)) return;
    score_ = value;
    chain_ = chain;
    layout.modules = g.modules();
    layout.islands = g.islands();
    report(progress_, "growing modules", -1.0, fmt::format("{} modules in {} islands", layout.modules.size(), layout.islands));
  }

  ModuleLayout layout;

 private:
  const double island_cost_;
  const ProgressSink& progress_;
  std::mutex mutex_;
  double score_ = -1.0;
  int chain_ = 0;
};

// One chain: the best of some random layouts, then annealing by ruin and recreate.
void run_chain(int chain, const Surface& surface, const std::vector<double>& area_sums, const LayoutLimits& limits,
               const SurfaceLatticeOptions& options, Clock::time_point start, Clock::time_point deadline, Best& best) {
  const std::uint64_t seed = options.seed * 1'000'003ULL + static_cast<std::uint64_t>(chain) * 7919ULL;
  std::optional<Grower> current;
  const auto total = deadline - start;
  for (int k = 0; k < options.layouts && (k == 0 || Clock::now() < start + total / 4); ++k) {
    Grower g(surface, area_sums, limits, seed + static_cast<std::uint64_t>(k));
    g.grow(k == 0 ? deadline + std::chrono::seconds(2) : deadline);
    best.offer(chain, g);
    if (!current || g.score(options.island_cost) > current->score(options.island_cost)) current.emplace(std::move(g));
  }
  std::mt19937_64 random(seed);
  for (int k = 0; k < options.ruins && Clock::now() < deadline; ++k) {
    const double left = std::chrono::duration<double>(deadline - Clock::now()) / std::chrono::duration<double>(total);
    const double progress = options.ruins < 1'000'000 ? static_cast<double>(k) / options.ruins : 1.0 - left;
    // Mostly small balls; now and then a large one. Losses of a module are allowed early.
    const double radius_mm = 18.0 + 50.0 * std::pow(static_cast<double>(random() >> 11) * 0x1p-53, 2.0);
    const double allowed = static_cast<double>(random() % 100) < 25.0 * (1.0 - progress) ? 1.05 : 0.0;
    current->ruin_and_recreate(radius_mm, allowed, options.island_cost, deadline);
    best.offer(chain, *current);
  }
}

}  // namespace

ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits, const SurfaceLatticeOptions& options, const ProgressSink& progress) {
  const auto start = Clock::now();
  const auto deadline = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.time_limit_s));
  const std::vector<double> area_sums = running_area(surface);
  Best best(options.island_cost, progress);
  {
    std::vector<std::jthread> threads;
    for (int c = 1; c < options.chains; ++c) {
      threads.emplace_back([&, c] { run_chain(c, surface, area_sums, limits, options, start, deadline, best); });
    }
    run_chain(0, surface, area_sums, limits, options, start, deadline, best);
  }
  ModuleLayout layout = std::move(best.layout);
  layout.method = "surface";
  layout.islands = 0;
  keep_limits(surface, limits, layout);  // growing walks the sides coarsely: the exact measure decides
  return layout;
}

}  // namespace triskin::geometry
