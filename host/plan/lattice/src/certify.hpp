// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <vector>

#include "canonical.hpp"
#include "net.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::lattice {

/// Makes layouts of nets on the original surface, in which every module keeps every limit as `measure` measures it: the
/// finer walk along the sides may find what the search did not. Modules that break a limit are removed, the worst
/// first; kept modules stay. The measurements of the first net's modules are reused for the others, which differ from
/// it in few.
class Certifier {
 public:
  /// All arguments must outlive the object. Of the options it uses the kept modules, regions and threads.
  Certifier(const mesh::Surface& original, const CanonicalCopy& copy, const LayoutLimits& limits,
            const SurfaceLatticeOptions& options)
      : surface_(original), copy_(copy), limits_(limits), options_(options) {}

  /// Uses all threads. Cost: some 0.1 ms per module.
  [[nodiscard]] ModuleLayout first(LatticeMesh net) { return certified(std::move(net), known_, options_.threads); }
  /// Runs on the calling thread; thread-safe after first().
  [[nodiscard]] ModuleLayout other(const LatticeMesh& net) const {
    Known own;
    return certified(net, own, 1);
  }

 private:
  using Corners = std::array<double, 9>;
  using Known = std::map<Corners, PlacedModule>;
  [[nodiscard]] ModuleLayout certified(LatticeMesh net, Known& own, int threads) const;
  [[nodiscard]] std::vector<int> turned_modules(const ModuleLayout& layout) const;
  void measure_on_surface(ModuleLayout& layout, Known& own, int threads) const;

  const mesh::Surface& surface_;
  const CanonicalCopy& copy_;
  const LayoutLimits& limits_;
  const SurfaceLatticeOptions& options_;
  Known known_;
};

}  // namespace triskin::lattice
