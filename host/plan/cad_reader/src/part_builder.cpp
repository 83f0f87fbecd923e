// SPDX-License-Identifier: GPL-3.0-or-later
#include "part_builder.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "body_mesh.hpp"
#include "face_facts.hpp"
#include "face_sides.hpp"

namespace triskin::cad_reader {
namespace {

constexpr int kMaxNamedFaces = 5;

std::string text(const char* format, auto... values) {
  std::array<char, 400> out{};
  std::snprintf(out.data(), out.size(), format, values...);
  return out.data();
}

std::string place_text(const Vec3& p) {
  return text("(%.1f, %.1f, %.1f) mm", p.x(), p.y(), p.z());
}

// Copies the triangles of a body into the part.
class PartBuilder {
 public:
  PartBuilder(const Document& document, double scale) : document_(document), scale_(scale) {}

  void add(const PlacedBody& placed, const BodyMesh& mesh) {
    cad::Body body{placed.name, placed.path, placed.colour, placed.shape.ShapeType() == TopAbs_SOLID};
    body.first_face = design::BrepFaceIndex(part.faces.size());
    body.face_count = static_cast<int>(mesh.faces.size());
    body.free_edges = mesh.free_edges;
    body.open_edges = mesh.open_edges;
    const std::vector<double> holes = hole_diameters(mesh.faces);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      part.faces.push_back(face_of(mesh.faces[f], placed.colour));
      part.faces.back().is_hidden = placed.is_hidden || label_of(document_, mesh.faces[f].face).is_hidden;
      part.faces.back().hole_diameter_mm = scale_ * holes[f];
      body.area_mm2 += part.faces.back().area_mm2;
    }
    add_triangles(mesh, body.first_face);
    part.bodies.push_back(std::move(body));
  }

  cad::Part part;

 private:
  [[nodiscard]] cad::Face face_of(const ExactFace& exact, const std::string& body_colour) const {
    const Label& said = label_of(document_, exact.face);
    cad::Face face;
    face.name = said.name;
    face.colour = said.colour.empty() ? body_colour : said.colour;
    face.entity = said.entity;
    face.kind = kind_of(exact);
    face.body = static_cast<int>(part.bodies.size());
    face.area_mm2 = scale_ * scale_ * exact.area_mm2;
    face.radius_mm = scale_ * radius_of(exact);
    face.deviation_mm = scale_ * exact.deviation_mm;
    face.place_mm = scale_ * exact.worst_mm;
    face.fault = exact.fault;
    return face;
  }
  void add_triangles(const BodyMesh& mesh, design::BrepFaceIndex first_face) {
    const int base = static_cast<int>(part.mesh.vertices.size());
    for (const Vec3& p : mesh.points) part.mesh.vertices.push_back(scale_ * p);
    for (const Triangle& t : mesh.triangles) {
      part.mesh.faces.push_back({base + t.corners[0], base + t.corners[1], base + t.corners[2]});
      part.face_of_triangle.emplace_back(first_face + t.face);
    }
  }

  const Document& document_;
  double scale_;
};

// Computes place and mean normal of every face from its triangles.
void set_places(cad::Part& part) {
  std::vector<Vec3> normals(part.faces.size(), Vec3::Zero()), middles = normals;
  std::vector<double> areas(part.faces.size(), 0.0), nearest(part.faces.size(), 1e300);
  const auto of = [&](std::size_t t) { return static_cast<std::size_t>(part.face_of_triangle[t]); };
  const auto at = [&](std::size_t t, std::size_t k) {
    return part.mesh.vertices[static_cast<std::size_t>(part.mesh.faces[t][k])];
  };
  const auto centre = [&](std::size_t t) { return Vec3((at(t, 0) + at(t, 1) + at(t, 2)) / 3.0); };
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    const Vec3 normal = 0.5 * (at(t, 1) - at(t, 0)).cross(at(t, 2) - at(t, 0));
    normals[of(t)] += normal;
    middles[of(t)] += normal.norm() * centre(t);
    areas[of(t)] += normal.norm();
  }
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    const double distance = (centre(t) - middles[of(t)] / areas[of(t)]).norm();
    if (!(distance < nearest[of(t)])) continue;
    nearest[of(t)] = distance;
    part.faces[of(t)].place_mm = centre(t);
  }
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    // The normals of a closed face cancel.
    if (normals[f].norm() > 0.05 * areas[f]) part.faces[f].normal = normals[f].normalized();
  }
}

std::string face_name(const cad::Part& part, std::size_t f) {
  const cad::Face& face = part.faces[f];
  return "face " + std::to_string(f) + (face.entity.empty() ? "" : " (" + face.entity + ")");
}

void list_faults(cad::Part& part) {
  int failed = 0;
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const cad::Face& face = part.faces[f];
    if (face.fault.empty() || ++failed > kMaxNamedFaces) continue;
    part.faults.push_back(face_name(part, f) + " " + face.fault + " at " + place_text(face.place_mm));
  }
  if (failed > kMaxNamedFaces)
    part.faults.push_back(std::to_string(failed - kMaxNamedFaces) + " more faces have no sound mesh");
  for (std::size_t b = 0; b < part.bodies.size(); ++b) {
    const cad::Body& body = part.bodies[b];
    if (body.open_edges > 0)
      part.faults.push_back(text("the mesh of body %zu has %d open edges that the file has not", b, body.open_edges));
    if (body.is_solid && body.free_edges > 0)
      part.faults.push_back(text("body %zu is called a solid and has %d edges of one face", b, body.free_edges));
  }
}

void state_deviation(cad::Part& part, double wanted_mm) {
  std::size_t worst = 0;
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    if (part.faces[f].deviation_mm > part.faces[worst].deviation_mm) worst = f;
  }
  part.deviation_mm = part.faces.empty() ? 0.0 : part.faces[worst].deviation_mm;
  if (part.deviation_mm <= wanted_mm || !part.faces[worst].fault.empty()) return;
  part.warnings.push_back(text("the mesh deviates by up to %.3f mm from the exact surface where %.3g mm were wanted: ",
                               part.deviation_mm, wanted_mm) +
                          face_name(part, worst) + ", whose edges in the file lie beside its surface");
}

}  // namespace

cad::Part build_part(const Document& document, const BuildOptions& options, const StageSink& stage) {
  const double unit_mm = options.unit_mm > 0.0 ? options.unit_mm : document.unit_mm;
  const double scale = unit_mm / document.unit_mm;
  PartBuilder builder(document, scale);
  for (std::size_t b = 0; b < document.bodies.size(); ++b) {
    stage("meshing body " + std::to_string(b) + " of " + std::to_string(document.bodies.size()));
    builder.add(document.bodies[b], mesh_body(document.bodies[b].shape, options.max_deviation_mm / scale));
  }
  cad::Part part = std::move(builder.part);
  part.unit = document.unit;
  part.unit_mm = unit_mm;
  part.unit_given = options.unit_mm > 0.0;
  part.warnings = document.warnings;
  part.faults = document.faults;
  stage("looking which faces are outside");
  set_places(part);
  state_deviation(part, options.max_deviation_mm);
  list_faults(part);
  decide_sides(part);
  return part;
}

}  // namespace triskin::cad_reader
