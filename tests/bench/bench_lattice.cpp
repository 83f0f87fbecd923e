// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the growth on curved surfaces by counted steps, and the division into flat pieces by edge error and size.
#include <cmath>
#include <cstddef>

#include "bench.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::cli {
namespace {

using nlohmann::json;

mesh::Surface generated(const char* shape, int faces, double size_mm = 0.0) {
  return mesh::Surface(mesh::generate(*mesh::shape_named(shape), {.size_mm = size_mm, .faces = faces}));
}

// One chain, so that the result depends on seed and steps alone.
json grown(const char* series, const char* shape, const mesh::Surface& surface, int steps, std::uint64_t seed) {
  lattice::SurfaceLatticeOptions options;
  options.iterations = steps;
  options.time_limit_s = 1e4;
  options.threads = 1;
  options.seed = seed;
  options.front = false;
  const double start = processor_s();
  const design::ModuleLayout layout = lattice::grow_lattice(surface, {}, options);
  return {{"series", series},
          {"shape", shape},
          {"seed", seed},
          {"steps", steps},
          {"area_cm2", surface.area_mm2() / 100.0},
          {"faces", surface.mesh().faces.size()},
          {"modules", layout.modules.size()},
          {"islands", layout.islands},
          {"bound", std::floor(surface.area_mm2() / design::kModuleArea_mm2)},
          {"processor_s", processor_s() - start}};
}

json pieces(const char* series, const char* shape, const mesh::Surface& surface, double edge_error_mm) {
  const double start = processor_s();
  const unfolding::Net net = unfolding::unfold(surface, {.edge_error_mm = edge_error_mm});
  return {{"series", series},
          {"shape", shape},
          {"faces", surface.mesh().faces.size()},
          {"edge_error_mm", edge_error_mm},
          {"pieces", net.pieces.size()},
          {"overlaps", net.overlaps},
          {"processor_s", processor_s() - start}};
}

json rows(const BenchOptions& options, Output&) {
  json result = json::array();
  for (const char* shape : {"forearm", "torso", "hip", "thigh"}) {
    const mesh::Surface surface = generated(shape, 0);
    for (const int steps : {1, 10, 30, 100, 300, 1000, 3000}) {
      if (options.quick && steps > 300) continue;
      for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U})
        result.push_back(grown("steps", shape, surface, steps, seed));
    }
    for (const double error_mm : {0.1, 0.2, 0.5, 1.0, 2.0, 4.0})
      result.push_back(pieces("pieces", shape, surface, error_mm));
  }
  for (const int faces : {500, 2'000, 8'000, 32'000}) {
    result.push_back(pieces("pieces by size", "torso", generated("torso", faces), 1.0));
    if (!options.quick || faces <= 8'000) result.push_back(grown("faces", "torso", generated("torso", faces), 30, 1));
  }
  for (const double size_mm : {150.0, 300.0, 600.0, 1200.0}) {
    if (options.quick && size_mm > 600.0) continue;
    // The number of faces follows the area, so that a face keeps its size.
    const int faces = static_cast<int>(2'000 * size_mm * size_mm / (300.0 * 300.0));
    result.push_back(grown("area", "forearm", generated("forearm", std::max(500, faces), size_mm), 30, 1));
  }
  return result;
}

const BenchSubject kLattice("lattice", "growth by counted steps, pieces by edge error: value against the bound", rows);

}  // namespace
}  // namespace triskin::cli
