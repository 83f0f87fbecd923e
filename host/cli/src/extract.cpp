// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/extract.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "mesh_options.hpp"
#include "triskin/cli/command.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::cli {
namespace {

struct Options {
  std::string mesh, output;
  UnitOption unit;
};

int run(const Options& options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  const geometry::MeshFile file = geometry::read_mesh(options.mesh, options.unit.unit);
  const geometry::Extraction e = geometry::extract(file.mesh, output.progress());
  geometry::write_obj(options.output, e.surface);
  const double area_cm2 = geometry::Surface(e.surface).area_mm2() / 100.0;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.result = {{"faces", e.surface.faces.size()}, {"area_cm2", area_cm2}, {"removed_components", e.report.removed_components},
                   {"boundary_loops", e.report.boundary_loops}, {"flipped_faces", e.report.flipped_faces}, {"seconds", seconds}};
  output.say(fmt::format("{} faces, {:.1f} cm², {} border loops; {} parts removed, {} faces turned; {:.2f} s", e.surface.faces.size(),
                         area_cm2, e.report.boundary_loops, e.report.removed_components, e.report.flipped_faces, seconds));
  return 0;
}

const Registration kExtract{{
    "extract", "make a clean surface of a raw CAD mesh", "triskin extract cover.stl -o surface.obj",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("MESH", options->mesh, "OBJ, STL, PLY, OFF or DAE")->required();
      app.add_option("-o,--output", options->output, "surface (OBJ, mm)")->required();
      options->unit.add_to(app);
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli
