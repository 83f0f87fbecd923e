// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/extract.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <vector>

#include "command.hpp"
#include "face_options.hpp"
#include "mesh_options.hpp"
#include "number_list.hpp"
#include "part_text.hpp"
#include "read_text.hpp"
#include "repair_text.hpp"
#include "side_option.hpp"
#include "side_picture.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/open_side.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::cli::extract_command {
namespace {

using When = mesh::ExtractOptions::When;

struct Options {
  std::string mesh, output, object, keep_out, picture;
  SideOption side;
  UnitOption unit;
  FaceOptions faces;
  mesh::ExtractOptions steps;
  std::vector<std::string> spheres, boxes;
  bool flip = false;
};

void take_keep_outs(Options& o) {
  for (const std::string& text : o.spheres) {
    const auto s = numbers_of(text);
    if (s.size() != 4 || !(s[3] > 0.0))
      throw InputError(fmt::format("extract: --keep-out-sphere {}: wanted x,y,z,r in mm with r > 0", text));
    o.steps.spheres.push_back({{s[0], s[1], s[2]}, s[3]});
  }
  for (const std::string& text : o.boxes) {
    const auto b = numbers_of(text);
    if (b.size() != 6 || !(b[0] < b[3] && b[1] < b[4] && b[2] < b[5])) {
      throw InputError(
          fmt::format("extract: --keep-out-box {}: wanted x0,y0,z0,x1,y1,z1 in mm with each 0 below its 1", text));
    }
    o.steps.boxes.push_back({{b[0], b[1], b[2]}, {b[3], b[4], b[5]}});
  }
  if (!o.keep_out.empty()) o.steps.keep_out = mesh::read_mesh(o.keep_out, o.unit.unit).mesh;
}

nlohmann::json dropped_of(const mesh::ExtractReport& report) {
  nlohmann::json list = nlohmann::json::array();
  for (const mesh::DroppedPart& part : report.dropped) {
    const design::Vec3& p = part.where_mm;
    list.push_back({{"area_cm2", part.area_mm2 / 100.0}, {"faces", part.faces}, {"where_mm", {p.x(), p.y(), p.z()}}});
  }
  return list;
}

nlohmann::json keys_of(const mesh::ExtractReport& report) {
  return {{"dropped", dropped_of(report)},
          {"removed_components", report.removed_components},
          {"enclosed_components", report.enclosed_components},
          {"flipped_faces", report.flipped_faces},
          {"components", report.components},
          {"non_manifold_edges", report.non_manifold_edges},
          {"outer", report.outer},
          {"wrapped", report.wrapped},
          {"kept_out_cm2", report.kept_out_mm2 / 100.0},
          {"repair", mesh::kRepairNames.name(report.repair)},
          {"crossings", report.crossings},
          {"deviation_mm", report.deviation.largest_mm},
          {"deviation_found_mm", report.deviation.found_mm},
          {"mean_deviation_mm", report.deviation.mean_mm},
          {"reduced_mm", report.reduced_mm},
          {"crossing_tested", report.tested}};
}

int run(Options options, Output& output) {
  mesh::require_mesh_output(options.output);
  require_writable(options.output);
  take_keep_outs(options);
  const mesh::SideOptions side_options = options.side.options();
  const auto start = std::chrono::steady_clock::now();
  const mesh::MeshFile file =
      mesh::read_mesh(options.mesh, options.unit.unit, options.object, options.faces.selection());
  say_notes(options.mesh, file.report.notes, output);
  mesh::Extraction e = mesh::extract(file.mesh, options.steps, output.progress());
  if (options.flip) mesh::turn_over(e.surface);
  mesh::TakenSide taken = mesh::take_side(e.surface, side_options);
  if (taken.is_undecided)
    return report_undecided(e.surface, taken, options.picture.empty() ? options.output + ".svg" : options.picture,
                            output);
  if (!options.picture.empty()) write_output(options.picture, side_svg(e.surface, taken.choice));
  mesh::BridgeReport bridges;
  if (options.side.bridge_mm() > 0.0) bridges = mesh::bridge_holes(taken.surface, e.surface, options.side.bridge_mm());
  const mesh::OpenSide open_side = mesh::open_side_of(taken.surface);
  mesh::write_mesh(options.output, taken.surface);
  const mesh::Surface surface(taken.surface);
  const double area_cm2 = surface.area_mm2() / 100.0;
  Eigen::AlignedBox3d box;
  for (const design::Vec3& v : file.mesh.vertices) box.extend(v);
  const design::Vec3 size_mm = box.sizes();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.result = keys_of(e.report);
  output.result.update({{"faces", taken.surface.faces.size()},
                        {"area_cm2", area_cm2},
                        {"size_mm", {size_mm.x(), size_mm.y(), size_mm.z()}},
                        {"boundary_loops", surface.border_loops().size()},
                        {"notes", file.report.notes},
                        {"open", open_side.is_open},
                        {"toward_middle", open_side.toward_middle},
                        {"seconds", seconds}});
  add_side_keys(taken, output);
  output.result["bridged_holes"] = bridges.bridged;
  if (const std::string open = taken.choice.has_wall ? "" : side_text_of(open_side); !open.empty()) output.say(open);
  const int status = report_part(file.report, output);
  for (const std::string& text : {shortage_text(e.report), repair_text(e.report, "outer"), dropped_text(e.report),
                                  side_text(taken), bridge_text(bridges)}) {
    if (!text.empty()) output.say(text);
  }
  output.say(fmt::format("part of {:.1f} × {:.1f} × {:.1f} mm: {}, {:.1f} cm², {}; {} removed, {} turned; {:.2f} s",
                         size_mm.x(), size_mm.y(), size_mm.z(), counted(taken.surface.faces.size(), "face"), area_cm2,
                         counted(surface.border_loops().size(), "border loop"),
                         counted(e.report.removed_components, "part"), counted(e.report.flipped_faces, "face"),
                         seconds));
  return status;
}

const Registration kExtract{{
    "extract",
    "make a clean surface of a raw CAD mesh",
    "triskin extract cover.stl -o surface.obj",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("MESH", options->mesh, "OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF, STEP or IGES")->required();
      app.add_option("-o,--output", options->output, "surface (OBJ or STL, mm)")->required();
      options->unit.add_to(app);
      add_object_option(app, options->object);
      options->side.add_to(app);
      app.add_option("--picture", options->picture, "SVG of the part with its sides coloured");
      app.add_flag("--flip", options->flip, "turn all faces over: the other side of an open part");
      options->faces.add_to(app);
      const std::map<std::string, When> when{
          {"never", When::kNever}, {"auto", When::kWhenNeeded}, {"always", When::kAlways}};
      auto& s = options->steps;
      s.repair = true;
      s.outer = s.wrap = When::kWhenNeeded;
      app.add_option("--outer", s.outer,
                     "drop hidden faces: never, auto (several parts, or edges with more than two faces), always")
          ->transform(one_of(when));
      app.add_option("--sky", s.visibility_fraction, "share of the sky that an outer face sees")
          ->check(CLI::Range(0.0, 1.0))
          ->capture_default_str();
      app.add_option("--wrap", s.wrap, "shrink-wrap: never, auto (what is left is shattered or crosses itself), always")
          ->transform(one_of(when));
      app.add_option("--wrap-alpha-mm", s.wrap_alpha_mm, "openings narrower than this are closed")
          ->check(CLI::Range(0.1, 1e3))
          ->capture_default_str();
      app.add_option("--wrap-offset-mm", s.wrap_offset_mm, "the wrap lies this far outside")
          ->check(CLI::Range(0.001, 10.0))
          ->capture_default_str();
      app.add_option("--keep-out-sphere", options->spheres, "x,y,z,r in mm: no surface there; may be repeated");
      app.add_option("--keep-out-box", options->boxes, "x0,y0,z0,x1,y1,z1 in mm; may be repeated");
      app.add_option("--keep-out-mesh", options->keep_out, "closed mesh: no surface inside it")
          ->check(CLI::ExistingFile);
      app.add_option("--keep-out-margin-mm", s.keep_out_margin_mm, "nor nearer to it than this")
          ->check(CLI::Range(0.0, 1e3))
          ->capture_default_str();
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::extract_command
