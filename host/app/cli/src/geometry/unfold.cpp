// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "command.hpp"
#include "face_options.hpp"
#include "mesh_options.hpp"
#include "net_picture.hpp"
#include "part_text.hpp"
#include "read_text.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/unfolding/bend_seams.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::cli::unfold_command {
namespace {

using nlohmann::json;

struct Options {
  std::string surface, output, picture, seams, uncut;
  std::string object;
  UnitOption unit;
  FaceOptions faces;
  double bend_radius_mm = 0.0;
  unfolding::UnfoldingOptions unfolding;
};

json ring_json(const std::vector<design::Vec2>& ring) {
  json out = json::array();
  for (const auto& p : ring) out.push_back({p.x(), p.y()});
  return out;
}

json net_json(const unfolding::Net& net) {
  json pieces = json::array();
  for (const design::Piece& p : net.pieces) {
    json holes = json::array(), flat = json::array();
    for (const auto& hole : p.outline.holes) holes.push_back(ring_json(hole));
    for (const auto& t : p.flat) flat.push_back(ring_json({t.begin(), t.end()}));
    pieces.push_back({{"outline", ring_json(p.outline.outer)},
                      {"holes", std::move(holes)},
                      {"faces", p.faces},
                      {"flat", std::move(flat)},
                      {"max_edge_error_mm", p.max_edge_error_mm},
                      {"rms_edge_error_mm", p.rms_edge_error_mm}});
  }
  return {{"format", "triskin-net"}, {"version", 1}, {"pieces", std::move(pieces)}};
}

std::vector<unfolding::SurfaceEdge> edges_of(const std::string& file, const mesh::Surface& surface,
                                             const Options& options, Output& output) {
  std::vector<std::string> notes;
  const unfolding::SeamLines lines = unfolding::read_seams(file, options.unit.unit, &notes);
  for (const std::string& note : notes) output.say(note);
  return unfolding::edges_along(surface, lines, file);
}

struct EdgeErrors {
  double max_mm = 0.0, rms_mm = 0.0;
};

// A piece counts by its number of faces.
EdgeErrors edge_errors_of(const unfolding::Net& net) {
  EdgeErrors errors;
  double squares = 0.0, faces = 0.0;
  for (const auto& p : net.pieces) {
    const auto n = static_cast<double>(p.faces.size());
    errors.max_mm = std::max(errors.max_mm, p.max_edge_error_mm);
    squares += n * p.rms_edge_error_mm * p.rms_edge_error_mm;
    faces += n;
  }
  errors.rms_mm = std::sqrt(squares / faces);
  return errors;
}

int run(Options options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  require_writable(options.output);
  const mesh::MeshFile file =
      mesh::read_mesh(options.surface, options.unit.unit, options.object, options.faces.selection());
  say_notes(options.surface, file.report.notes, output);
  const mesh::Surface surface(mesh::extract(file.mesh).surface);
  if (!options.seams.empty()) options.unfolding.seams = edges_of(options.seams, surface, options, output);
  if (!options.uncut.empty()) options.unfolding.uncut = edges_of(options.uncut, surface, options, output);
  if (options.bend_radius_mm > 0.0) {
    const auto bends = unfolding::seams_along_bends(surface, options.bend_radius_mm);
    options.unfolding.seams.insert(options.unfolding.seams.end(), bends.begin(), bends.end());
    output.say(fmt::format("{} edges cut along what bends more than {:g} mm", bends.size(), options.bend_radius_mm));
  }
  const unfolding::Net net = unfolding::unfold(surface, options.unfolding, output.progress());
  write_output(options.output, net_json(net).dump() + "\n");
  if (!options.picture.empty()) write_output(options.picture, net_svg(surface, net, options.unfolding.edge_error_mm));
  const EdgeErrors errors = edge_errors_of(net);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.result = {{"pieces", net.pieces.size()},        {"area_cm2", surface.area_mm2() / 100.0},
                   {"max_edge_error_mm", errors.max_mm}, {"rms_edge_error_mm", errors.rms_mm},
                   {"overlaps", net.overlaps},           {"seconds", seconds}};
  output.say(fmt::format("{}, {:.1f} cm², edge error at most {:.3f} mm (rms {:.3f} mm) on 30 mm, {}; {:.2f} s",
                         counted(net.pieces.size(), "piece"), surface.area_mm2() / 100.0, errors.max_mm, errors.rms_mm,
                         counted(net.overlaps, "overlap"), seconds));
  return report_part(file.report, output);
}

const Registration kUnfold{{
    "unfold",
    "unfold a surface into flat pieces at true scale",
    "triskin unfold surface.obj -o net.json",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("SURFACE", options->surface, "mesh, STEP or IGES, as extract reads them")->required();
      app.add_option("-o,--output", options->output, "net (JSON, docs/unfolding.md)")->required();
      app.add_option("--edge-error-mm", options->unfolding.edge_error_mm, "largest edge error on 30 mm")
          ->check(CLI::Range(1e-6, 30.0))
          ->capture_default_str();
      app.add_option("--seams", options->seams, "OBJ with polylines (v, l): cut the surface open along them");
      app.add_option("--no-seams", options->uncut, "OBJ with polylines (v, l): never cut there");
      app.add_option("--bend-radius-mm", options->bend_radius_mm,
                     "also cut around what bends more than this, as the reference paper does at 50 (0: no)")
          ->check(CLI::Range(0.0, 1e4))
          ->capture_default_str();
      app.add_option("--darts", options->unfolding.darts, "most cuts into a piece before it is divided instead")
          ->check(CLI::Range(0, 100))
          ->capture_default_str();
      app.add_option("--picture", options->picture, "also an SVG: pieces, triangles coloured by their edge error");
      options->unit.add_to(app);
      add_object_option(app, options->object);
      options->faces.add_to(app);
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::unfold_command
