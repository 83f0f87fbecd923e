// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/mesh_io.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "clean.hpp"
#include "library_reader.hpp"
#include "lower_case.hpp"
#include "object_filter.hpp"
#include "off_reader.hpp"
#include "ply_reader.hpp"
#include "text_readers.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/files.hpp"
#include "triskin/cad/read_part.hpp"

namespace triskin::geometry {
namespace {

constexpr double kSmallestPart_mm = 20.0;
constexpr double kLargestGuess_mm = 3000.0;  // without a unit
constexpr double kLargestPart_mm = 5000.0;

void require_finite(const std::filesystem::path& path, const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) {
      throw InputError(
          fmt::format("{}: vertex {} is not a finite point; repair or export the mesh again", path.string(), v));
    }
  }
}

// Without a unit from the person or the file, a size that no part has is a question.
void require_size(const std::filesystem::path& path, const Mesh& mesh, bool unit_is_known) {
  const double size_mm = diagonal_of(mesh);
  if (size_mm < kSmallestPart_mm) {
    const bool metres = 1000.0 * size_mm <= kLargestGuess_mm;
    throw InputError(
        fmt::format("{}: the mesh is only {:.3g} mm across, no module of 30 mm fits; are its numbers {}? Then pass "
                    "{} (--unit m or --unit cm)",
                    path.string(), size_mm, metres ? "metres" : "centimetres", metres ? "--unit m" : "--unit cm"));
  }
  if (size_mm > kLargestPart_mm) {
    throw InputError(
        fmt::format("{}: the mesh is {:.3g} m across, larger than a body part (5 m); check its unit (--unit mm|cm|m)",
                    path.string(), size_mm / 1000.0));
  }
  if (size_mm > kLargestGuess_mm && !unit_is_known) {
    throw InputError(
        fmt::format("{}: the mesh is {:.3g} m across if its numbers are millimetres; are they? Then pass "
                    "--unit mm",
                    path.string(), size_mm / 1000.0));
  }
}

bool is_off(const std::filesystem::path& path, const std::string& bytes) {
  return extension_of(path) == ".off" || bytes.starts_with("OFF") || bytes.starts_with("COFF") ||
         bytes.starts_with("NOFF");
}

void require_object(const std::filesystem::path& path, const ObjectFilter& objects) {
  if (objects.wanted.empty() || objects.names.contains(objects.wanted)) return;
  if (objects.names.empty())
    throw InputError(fmt::format("{}: has no named objects; leave \"{}\" out", path.string(), objects.wanted));
  throw InputError(fmt::format("{}: has no object \"{}\"; it has {}", path.string(), objects.wanted,
                               fmt::join(objects.names, ", ")));
}

Mesh read_any(const std::filesystem::path& path, const std::string& bytes, ObjectFilter& objects,
              MeshReadReport& report) {
  const std::string extension = extension_of(path);
  if (is_off(path, bytes)) return read_off(bytes, path.string());
  if (extension == ".obj") return read_obj(bytes, path.string(), objects);
  if (extension == ".stl")
    return is_binary_stl(bytes) ? read_binary_stl(bytes) : read_text_stl(bytes, path.string(), objects);
  if (extension == ".ply") return read_ply(bytes, path.string());
  MeshInUnit read = extension == ".3mf" ? read_3mf(path, objects) : read_with_library(path, bytes, objects);
  report.unit_from_file = read.unit_mm > 0.0;
  if (report.unit_from_file) report.scale_to_mm = read.unit_mm;
  return std::move(read.mesh);
}

cad::FaceSelection with_body(cad::FaceSelection faces, const std::string& object) {
  if (!object.empty()) faces.bodies.push_back(object);
  return faces;
}

MeshFile read_part_mesh(const std::filesystem::path& path, const std::string& bytes, std::optional<LengthUnit> unit,
                        const cad::FaceSelection& faces) {
  cad::ReadOptions options;
  if (unit) options.unit_mm = scale_of(*unit);
  const cad::Part part = cad::read_part_bytes(bytes, path.string(), options);
  MeshFile file;
  PartReport report{{}, static_cast<int>(part.faces.size()), part.deviation_mm, part.warnings, part.faults};
  try {
    report.faces = cad::select_faces(part, faces);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
  file.mesh = cad::mesh_of_faces(part, report.faces);
  file.report.scale_to_mm = part.unit_mm;
  file.report.unit_from_file = !part.unit.empty();
  file.report.part = std::move(report);
  clean(file.mesh, file.report, Corners::kKept);
  if (file.mesh.faces.empty()) throw InputError(fmt::format("{}: no triangle with an area in it", path.string()));
  require_size(path, file.mesh, unit.has_value() || file.report.unit_from_file);
  return file;
}

}  // namespace

double scale_of(LengthUnit unit) {
  if (unit == LengthUnit::kMetre) return 1000.0;
  if (unit == LengthUnit::kInch) return 25.4;
  return unit == LengthUnit::kCentimetre ? 10.0 : 1.0;
}

MeshFile read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit, const std::string& object,
                   const cad::FaceSelection& faces) {
  const std::string bytes = read_file(path);  // names the file when it cannot be read
  if (cad::is_cad_file(path, bytes)) return read_part_mesh(path, bytes, unit, with_body(faces, object));
  if (!faces.is_empty()) {
    throw InputError(fmt::format("{}: only STEP and IGES files have faces to choose; leave the options for faces out",
                                 path.string()));
  }
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty", path.string()));
  MeshFile file;
  ObjectFilter objects{object, {}};
  file.mesh = read_any(path, bytes, objects, file.report);
  require_object(path, objects);
  if (unit) file.report.scale_to_mm = scale_of(*unit);
  require_finite(path, file.mesh);
  for (Vec3& v : file.mesh.vertices) v *= file.report.scale_to_mm;
  clean(file.mesh, file.report);
  if (file.mesh.faces.empty()) throw InputError(fmt::format("{}: no triangle with an area in it", path.string()));
  require_size(path, file.mesh, unit.has_value() || file.report.unit_from_file);
  return file;
}

Mesh read_obj_group(const std::filesystem::path& path, const std::string& group, double scale_to_mm) {
  if (extension_of(path) != ".obj")
    throw InputError(fmt::format("{}: only OBJ files have named groups; give faces, a sphere or a box", path.string()));
  ObjectFilter objects{group, {}};
  Mesh mesh = read_obj(read_file(path), path.string(), objects);
  if (!objects.names.contains(group)) {
    throw InputError(objects.names.empty() ? fmt::format("{}: has no group \"{}\", nor any other", path.string(), group)
                                           : fmt::format("{}: has no group \"{}\"; it has {}", path.string(), group,
                                                         fmt::join(objects.names, ", ")));
  }
  for (Vec3& v : mesh.vertices) v *= scale_to_mm;
  return mesh;
}

void write_obj(const std::filesystem::path& path, const Mesh& mesh) {
  std::string text = "# triskin, mm\n";
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& f : mesh.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  write_output(path, text);
}

}  // namespace triskin::geometry
