// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/generate.hpp"

#include <fmt/format.h>

#include <memory>

#include "command.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::cli::generate_command {
namespace {

struct Options {
  std::string shape, output;
  mesh::GenerateOptions mesh;
};

// Lists the names of the shapes and the difficulty that each presents.
std::string shape_lines() {
  std::string text;
  for (const mesh::ShapeInfo& s : mesh::generated_shapes())
    text += fmt::format("{}  {:<16} {} ({:.0f} mm, {})", text.empty() ? "" : "\n", s.name, s.summary, s.size_mm,
                        counted(s.faces, "face"));
  return text;
}

int list(Output& output) {
  for (const mesh::ShapeInfo& s : mesh::generated_shapes()) {
    output.result["shapes"].push_back(
        {{"name", s.name}, {"summary", s.summary}, {"size_mm", s.size_mm}, {"faces", s.faces}});
  }
  output.say(shape_lines());
  return 0;
}

int run(const Options& options, Output& output) {
  if (options.shape == "list") return list(output);
  const auto shape = mesh::shape_named(options.shape);
  if (!shape) throw InputError(fmt::format("generate: no shape {}; there are\n{}", options.shape, shape_lines()));
  if (options.output.empty()) throw InputError("generate: -o FILE.obj is missing");
  const design::Mesh mesh = mesh::generate(*shape, options.mesh);
  mesh::write_mesh(options.output, mesh);
  output.result = {{"faces", mesh.faces.size()}};
  output.say(fmt::format("{}: {}", options.output, counted(mesh.faces.size(), "face")));
  return 0;
}

const Registration kGenerate{{
    "generate",
    "generate a sample surface",
    "triskin generate forearm -o forearm.obj",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("SHAPE", options->shape, "list, or one of\n" + shape_lines())->required();
      app.add_option("-o,--output", options->output, "mesh (OBJ, mm)");
      app.add_option("--size-mm", options->mesh.size_mm, "largest side of the bounding box, 20 … 5000");
      app.add_option("--faces", options->mesh.faces, "about so many triangles, 50 … 2000000");
      return [options](Output& output) { return run(*options, output); };
    },
}};

}  // namespace
}  // namespace triskin::cli::generate_command
