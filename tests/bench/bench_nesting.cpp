// SPDX-License-Identifier: GPL-3.0-or-later
// Measures how full the sheets are against the effort of the nesting.
#include <numeric>

#include "bench.hpp"
#include "triskin/fabrication/nesting.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {
namespace {

nlohmann::json rows(const BenchOptions& options, Output&) {
  nlohmann::json result = nlohmann::json::array();
  const Scratch scratch;
  for (const char* shape : {"forearm", "torso"}) {
    const std::filesystem::path file = scratch.path() / "part.obj";
    mesh::write_mesh(file, mesh::generate(*mesh::shape_named(shape), {}));
    pipeline::DesignOptions wanted;
    wanted.iterations = 60;
    wanted.threads = 1;
    wanted.time_limit_s = 1e4;
    const design::Design design = pipeline::make_design(file, wanted).design;
    const auto islands = fabrication::flat_islands(design, sheet::sides_of(design));
    for (const int tries : {1, 2, 5, 10, 20, 40, 80}) {
      if (options.quick && tries > 20) continue;
      const fabrication::SheetOptions sheet{.tries = tries};
      const double start = processor_s();
      const fabrication::Nesting nesting = fabrication::nest(islands, sheet);
      result.push_back({{"shape", shape},
                        {"modules", design.layout.modules.size()},
                        {"islands", islands.size()},
                        {"tries", tries},
                        {"sheets", nesting.used_mm.size()},
                        {"used_mm", std::accumulate(nesting.used_mm.begin(), nesting.used_mm.end(), 0.0)},
                        {"fill", nesting.fill.front()},
                        {"processor_s", processor_s() - start}});
    }
  }
  return result;
}

const BenchSubject kNesting("nesting", "islands on sheets: length used against effort", rows);

}  // namespace
}  // namespace triskin::cli
