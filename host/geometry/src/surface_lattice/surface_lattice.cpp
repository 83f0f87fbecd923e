// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/surface_lattice.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <atomic>
#include <mutex>
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

// The best layout so far; among equals the one with the lowest number, so that threads do not matter.
struct Best {
  std::mutex mutex;
  double score = -1.0;
  int number = -1;
  ModuleLayout layout;

  void offer(int k, const Grower& g, double island_cost, const ProgressSink& progress) {
    const double value = static_cast<double>(g.modules().size()) - island_cost * g.islands();
    const std::lock_guard lock(mutex);
    if (value < score || (value == score && k > number)) return;
    score = value;
    number = k;
    layout.modules = g.modules();
    layout.islands = g.islands();
    report(progress, "growing modules", -1.0, fmt::format("{} modules in {} islands", layout.modules.size(), layout.islands));
  }
};

}  // namespace

ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits, const SurfaceLatticeOptions& options, const ProgressSink& progress) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.time_limit_s));
  const std::vector<double> area_sums = running_area(surface);
  Best best;
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int k = next++; k < options.layouts && (k == 0 || Clock::now() < deadline); k = next++) {
      Grower grower(surface, area_sums, limits, options.seed * 1'000'003ULL + static_cast<std::uint64_t>(k));
      grower.grow(k == 0 ? deadline + std::chrono::seconds(5) : deadline);
      best.offer(k, grower, options.island_cost, progress);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int t = 1; t < options.threads; ++t) threads.emplace_back(work);
    work();
  }
  ModuleLayout layout = std::move(best.layout);
  layout.method = "surface";
  layout.islands = 0;
  keep_limits(surface, limits, layout);  // growing walks the sides coarsely: the exact measure decides
  return layout;
}

}  // namespace triskin::geometry
