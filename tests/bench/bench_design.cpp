// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the time limit of `design` with the time that it takes: reading, repair, pieces, growth, wiring and writing.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <string>

#include "bench.hpp"
#include "triskin/design/design.hpp"
#include "triskin/mesh/generate.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {
namespace {

namespace fs = std::filesystem;

struct Case {
  mesh::GenerateOptions size;
  bool quick;  // True includes the case in a run with --quick.
};
constexpr std::array kCases{Case{{0.0, 0}, true}, Case{{500.0, 20'000}, false}, Case{{2000.0, 100'000}, false}};

nlohmann::json row_of(const mesh::ShapeInfo& shape, const fs::path& folder, const fs::path& mesh, double limit_s) {
  pipeline::DesignOptions options;
  options.time_limit_s = limit_s;
  const auto start = std::chrono::steady_clock::now();
  const auto [design, notes] = pipeline::make_design(mesh, options);
  design::write_design(folder / "design.json", design);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {{"series", "time_limit"},
          {"shape", shape.name},
          {"limit_s", limit_s},
          {"seconds", seconds},
          {"over_limit_s", seconds - limit_s},
          {"late", seconds > std::max(1.2 * limit_s, limit_s + 1.0)},  // A design is late by more than 20 % and 1 s.
          {"solver_faces", notes.solver_faces},
          {"deviation_mm", notes.extract.deviation.largest_mm},
          {"modules", design.layout.modules.size()}};
}

nlohmann::json design_rows(const BenchOptions& options, Output&) {
  nlohmann::json rows = nlohmann::json::array();
  const Scratch scratch;
  for (const mesh::ShapeInfo& shape : mesh::generated_shapes()) {
    for (const Case& c : kCases) {
      if (options.quick && !c.quick) continue;
      const design::Mesh mesh = mesh::generate(shape.shape, c.size);
      const fs::path file = scratch.path() / "mesh.obj";
      mesh::write_obj(file, mesh);
      for (const double limit_s : {2.0, 6.0, 20.0}) {
        if (options.quick && limit_s > 2.0) continue;
        rows.push_back(row_of(shape, scratch.path(), file, limit_s));
        rows.back()["size_mm"] = c.size.size_mm > 0.0 ? c.size.size_mm : shape.size_mm;
        rows.back()["faces"] = mesh.faces.size();
      }
    }
  }
  return rows;
}

const BenchSubject kDesign("design", "whole designs of generated covers: modules and price against time", design_rows);

}  // namespace
}  // namespace triskin::cli
