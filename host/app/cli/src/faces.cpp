// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <map>
#include <memory>

#include "command.hpp"
#include "face_options.hpp"
#include "triskin/base/counted.hpp"
#include "triskin/base/files.hpp"
#include "triskin/cad/part_picture.hpp"
#include "triskin/cad/read_part.hpp"
#include "triskin/cad/select_faces.hpp"

namespace triskin::cli::faces_command {
namespace {

using nlohmann::json;

struct Options {
  std::string part, picture;
  cad::ReadOptions read;
  FaceOptions faces;
};

json vector_json(const design::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

json face_json(const cad::Part& part, design::BrepFaceIndex index) {
  const cad::Face& f = part.faces[static_cast<std::size_t>(index)];
  json out = {{"index", index},
              {"name", f.name},
              {"colour", f.colour},
              {"area_cm2", f.area_mm2 / 100.0},
              {"kind", cad::kSurfaceKindNames.name(f.kind)},
              {"outward", f.side == cad::FaceSide::kUndecided ? json() : json(f.side == cad::FaceSide::kOutward)},
              {"entity", f.entity},
              {"place_mm", vector_json(f.place_mm)},
              {"normal", vector_json(f.normal)},
              {"deviation_mm", f.deviation_mm}};
  if (f.radius_mm > 0.0) out["radius_mm"] = f.radius_mm;
  if (f.hole_diameter_mm > 0.0) out["hole_diameter_mm"] = f.hole_diameter_mm;
  if (!f.fault.empty()) out["fault"] = f.fault;
  return out;
}

json body_json(const cad::Part& part, int index, const std::vector<design::BrepFaceIndex>& chosen) {
  const cad::Body& b = part.bodies[static_cast<std::size_t>(index)];
  json faces = json::array();
  for (const design::BrepFaceIndex f : chosen) {
    if (part.faces[static_cast<std::size_t>(f)].body == index) faces.push_back(face_json(part, f));
  }
  return {{"index", index},
          {"name", b.name},
          {"path", b.path},
          {"colour", b.colour},
          {"solid", b.is_solid},
          {"area_cm2", b.area_mm2 / 100.0},
          {"free_edges", b.free_edges},
          {"open_edges", b.open_edges},
          {"faces", std::move(faces)}};
}

int failed_faces(const cad::Part& part) {
  return static_cast<int>(std::ranges::count_if(part.faces, [](const cad::Face& f) { return !f.fault.empty(); }));
}

json part_json(const cad::Part& part, const std::vector<design::BrepFaceIndex>& chosen, double seconds) {
  json bodies = json::array();
  double all_mm2 = 0.0, chosen_mm2 = 0.0;
  int solids = 0;
  for (int b = 0; b < static_cast<int>(part.bodies.size()); ++b) {
    bodies.push_back(body_json(part, b, chosen));
    all_mm2 += part.bodies[static_cast<std::size_t>(b)].area_mm2;
    solids += part.bodies[static_cast<std::size_t>(b)].is_solid ? 1 : 0;
  }
  for (const design::BrepFaceIndex f : chosen) chosen_mm2 += part.faces[static_cast<std::size_t>(f)].area_mm2;
  return {{"format", part.format},
          {"unit", part.unit.empty() ? json() : json(part.unit)},
          {"unit_mm", part.unit_mm},
          {"unit_given", part.unit_given},
          {"size_mm", vector_json(cad::size_of(part))},
          {"bodies", std::move(bodies)},
          {"solids", solids},
          {"faces", part.faces.size()},
          {"chosen", chosen.size()},
          {"area_cm2", all_mm2 / 100.0},
          {"chosen_cm2", chosen_mm2 / 100.0},
          {"triangles", part.mesh.faces.size()},
          {"deviation_mm", part.deviation_mm},
          {"failed_faces", failed_faces(part)},
          {"warnings", part.warnings},
          {"faults", part.faults},
          {"seconds", seconds}};
}

// Names may contain anything that the file contains, but read_part() removes control characters before they reach a
// terminal.
void say_face(const cad::Part& part, design::BrepFaceIndex index, const Output& output) {
  const cad::Face& f = part.faces[static_cast<std::size_t>(index)];
  std::string line = fmt::format("  {:>4}  {:<10} {:>9.3f} cm²  {:<9}", index, cad::kSurfaceKindNames.name(f.kind),
                                 f.area_mm2 / 100.0, cad::kFaceSideNames.name(f.side));
  if (!f.colour.empty()) line += "  " + f.colour;
  if (!f.name.empty()) line += fmt::format("  \"{}\"", f.name);
  if (f.radius_mm > 0.0) line += fmt::format("  radius {:.4g} mm", f.radius_mm);
  if (f.hole_diameter_mm > 0.0) line += "  hole";
  if (!f.fault.empty()) line += "  FAULT: " + f.fault;
  output.say(line);
}

void say_body(const cad::Part& part, int number, const std::vector<design::BrepFaceIndex>& chosen,
              const Output& output) {
  const cad::Body& body = part.bodies[static_cast<std::size_t>(number)];
  const char* kind = body.is_solid ? "solid" : "surface";
  output.say(fmt::format("body {} \"{}\": {}, {}, {:.3f} cm²{}", number, body.path, kind,
                         counted(body.face_count, "face"), body.area_mm2 / 100.0,
                         body.colour.empty() ? "" : ", " + body.colour));
  for (const design::BrepFaceIndex f : chosen) {
    if (part.faces[static_cast<std::size_t>(f)].body == number) say_face(part, f, output);
  }
}

void say_part(const cad::Part& part, const std::vector<design::BrepFaceIndex>& chosen, const json& totals,
              const Output& output) {
  for (int b = 0; b < static_cast<int>(part.bodies.size()); ++b) say_body(part, b, chosen, output);
  const design::Vec3 size = cad::size_of(part);
  output.say(fmt::format("{}, unit {}: {:.1f} × {:.1f} × {:.1f} mm, {}, {} of {:.3f} cm²; {} chosen, {:.3f} cm²",
                         part.format, part.unit.empty() ? "not named" : part.unit, size.x(), size.y(), size.z(),
                         counted(part.bodies.size(), "body"), counted(part.faces.size(), "face"),
                         totals["area_cm2"].get<double>(), chosen.size(), totals["chosen_cm2"].get<double>()));
  output.say(fmt::format("{} within {:.3f} mm of the exact surface; {:.2f} s",
                         counted(part.mesh.faces.size(), "triangle"), part.deviation_mm,
                         totals["seconds"].get<double>()));
  for (const std::string& warning : part.warnings) output.say("warning: " + warning);
  for (const std::string& fault : part.faults) output.say("fault: " + fault);
}

int run(const Options& options, Output& output) {
  const auto start = std::chrono::steady_clock::now();
  const cad::FaceSelection selection = options.faces.selection();
  const cad::Part part = cad::read_part(options.part, options.read);
  const std::vector<design::BrepFaceIndex> chosen = cad::select_faces(part, selection);
  if (!options.picture.empty()) write_output(options.picture, cad::part_svg(part, chosen));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.result = part_json(part, chosen, seconds);
  if (!output.json()) say_part(part, chosen, output.result, output);
  return part.faults.empty() ? 0 : 1;
}

const Registration kFaces{{
    "faces",
    "list the bodies and faces of a STEP or IGES file",
    "triskin faces cover.step --picture faces.svg",
    [](CLI::App& app) -> Run {
      auto options = std::make_shared<Options>();
      app.add_option("PART", options->part, "STEP (AP203, AP214, AP242) or IGES")->required();
      const std::map<std::string, double> units{{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}, {"inch", 25.4}};
      app.add_option("--unit", options->read.unit_mm, "unit of the file's numbers, whatever the file says")
          ->transform(one_of(units));
      app.add_option("--deviation-mm", options->read.max_deviation_mm,
                     "largest distance of the mesh from the exact surface")
          ->check(CLI::Range(0.001, 10.0))
          ->capture_default_str();
      app.add_option("--time-limit-s", options->read.time_limit_s, "limit of the reader's processor time")
          ->check(CLI::Range(0.1, 1e5))
          ->capture_default_str();
      app.add_option("--picture", options->picture, "SVG of the part from two sides with the index of each face");
      options->faces.add_to(app);
      return [options](Output& output) { return run(*options, output); };
    },
    Group::kDesign,
}};

}  // namespace
}  // namespace triskin::cli::faces_command
