// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/mesh_io.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "clean.hpp"
#include "edge_sides.hpp"
#include "formats/content_kind.hpp"
#include "formats/dae_reader.hpp"
#include "formats/gltf_reader.hpp"
#include "formats/mesh_source.hpp"
#include "formats/obj_reader.hpp"
#include "formats/off_reader.hpp"
#include "formats/ply_reader.hpp"
#include "formats/stl_reader.hpp"
#include "formats/three_mf_reader.hpp"
#include "triskin/base/error.hpp"
#include "triskin/base/file_kind.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/base/text_file.hpp"
#include "triskin/cad/read_part.hpp"

namespace triskin::mesh {
namespace {

constexpr double kSmallestPart_mm = 20.0;
// A robot's body part is hardly longer than an adult's leg or torso; a larger one is asked about: its unit is often
// wrong (a STEP file that says inch over numbers in mm).
constexpr double kLargestGuess_mm = 1500.0;
constexpr double kLargestPart_mm = 5000.0;

// A double still resolves 2 µm there; `check` has the same bound.
constexpr double kMaxCoordinate_mm = 1e10;

void require_bounded(const std::string& name, const Mesh& mesh, double scale) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) {
      throw InputError(fmt::format("{}: vertex {} is not a finite point; repair or export the mesh again", name, v));
    }
    if (scale * mesh.vertices[v].cwiseAbs().maxCoeff() > kMaxCoordinate_mm) {
      throw InputError(fmt::format(
          "{}: vertex {} is more than 10,000 km from the origin, where a number cannot tell micrometres any "
          "more; move the mesh to its origin, or check its unit (--unit mm|cm|m|in)",
          name, v));
    }
  }
}

struct UnitRow {
  const char *option, *plural;
  double mm;
};
constexpr std::array<UnitRow, 4> kUnits{
    {{"mm", "millimetres", 1.0}, {"cm", "centimetres", 10.0}, {"in", "inches", 25.4}, {"m", "metres", 1000.0}}};

std::string size_text(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return fmt::format("{:.0f} × {:.0f} × {:.0f}", box.sizes().x(), box.sizes().y(), box.sizes().z());
}

// Lists the units in which a mesh of this size (in its numbers) would be a body part, and how large it would be.
std::string fitting_units(double size_mm) {
  std::vector<std::string> names, options;
  for (const UnitRow& unit : kUnits) {
    const double size = size_mm * unit.mm;
    if (unit.mm == 1.0 || size < kSmallestPart_mm || size > kLargestGuess_mm) continue;
    names.push_back(fmt::format("{} ({:.3g} mm across)", unit.plural, size));
    options.push_back(fmt::format("--unit {}", unit.option));
  }
  if (names.empty()) return "check the unit of its numbers";
  return fmt::format("are its numbers {}? Then pass {}", fmt::join(names, " or "), fmt::join(options, " or "));
}

// Refuses a size that no part has, and asks about one that few have: only the person knows the unit.
void require_size(const std::string& name, const Mesh& mesh, double unit_mm, bool unit_is_given, bool unit_from_file) {
  const double size_mm = diagonal_of(mesh);
  if (size_mm < kSmallestPart_mm) {
    throw InputError(fmt::format("{}: the mesh is only {:.3g} mm across, no module of 30 mm fits; {}", name, size_mm,
                                 fitting_units(size_mm / unit_mm)));
  }
  if (size_mm > kLargestPart_mm) {
    throw InputError(fmt::format(
        "{}: the mesh is {:.3g} m across, larger than a body part (5 m); check its unit (--unit mm|cm|m|in)", name,
        size_mm / 1000.0));
  }
  if (size_mm <= kLargestGuess_mm || unit_is_given) return;
  const auto* unit = std::ranges::find(kUnits, unit_mm, &UnitRow::mm);
  const std::string read_as = unit == kUnits.end() ? fmt::format("units of {:g} mm", unit_mm) : unit->plural;
  const double as_mm = size_mm / unit_mm;
  const bool fits_mm = unit_mm != 1.0 && as_mm >= kSmallestPart_mm && as_mm <= kLargestGuess_mm;
  throw InputError(fmt::format(
      "{}: the part is {} mm large if its numbers are {}{}; are they? Then pass --unit {}{}", name, size_text(mesh),
      read_as, unit_from_file ? " as the file says" : "", unit == kUnits.end() ? "mm|cm|m|in" : unit->option,
      fits_mm ? fmt::format("; if they are millimetres ({:.3g} mm across), --unit mm", as_mm) : ""));
}

void require_object(const std::string& name, const ObjectFilter& objects) {
  if (objects.wanted.empty() || objects.names.contains(objects.wanted)) return;
  if (objects.names.empty())
    throw InputError(fmt::format("{}: has no named objects; leave \"{}\" out", name, objects.wanted));
  throw InputError(
      fmt::format("{}: has no object \"{}\"; it has {}", name, objects.wanted, fmt::join(objects.names, ", ")));
}

// The content decides. An extension that says something else is the user's mistake and gives a note.
MeshFormat format_of(const MeshSource& source, const std::string& extension) {
  const MeshFormat by_content = format_by_content(source.bytes), by_name = format_by_extension(extension);
  const bool is_same = name_of(by_content) == name_of(by_name);
  if (by_content != MeshFormat::kUnknown && by_name != MeshFormat::kUnknown && !is_same) {
    source.notes.push_back(fmt::format("holds {}, although its name says {}: it was read as {}", name_of(by_content),
                                       name_of(by_name), name_of(by_content)));
  }
  if (by_content != MeshFormat::kUnknown) return by_content;
  if (by_name == MeshFormat::kTextStl && is_binary_stl(source.bytes)) return MeshFormat::kBinaryStl;
  return by_name;
}

MeshInUnit read_as(MeshFormat format, const MeshSource& source) {
  switch (format) {
    case MeshFormat::kObj:
      return {read_obj(source)};
    case MeshFormat::kTextStl:
      return {read_text_stl(source)};
    case MeshFormat::kBinaryStl:
      return {read_binary_stl(source)};
    case MeshFormat::kPly:
      return {read_ply(source)};
    case MeshFormat::kOff:
      return {read_off(source)};
    case MeshFormat::kThreeMf:
      return read_3mf(source);
    case MeshFormat::kGltf:
      return read_gltf(source);
    case MeshFormat::kDae:
      return read_dae(source);
    case MeshFormat::kUnknown:
      break;
  }
  throw InputError(fmt::format(
      "{}: its format is not known here; give a mesh (OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF) or a part in "
      "STEP or IGES",
      source.name));
}

// A pipe has no folder in which a file beside it could lie.
std::filesystem::path folder_of(const std::filesystem::path& path) {
  std::error_code none;
  if (path == "-" || !std::filesystem::is_regular_file(path, none)) return {};
  return path.has_parent_path() ? path.parent_path() : ".";
}

cad::FaceSelection with_body(cad::FaceSelection faces, const std::string& object) {
  if (!object.empty()) faces.bodies.push_back(object);
  return faces;
}

// What was left out is often the reason, so the message has the notes.
void require_triangles(const std::string& name, const MeshFile& file) {
  if (!file.mesh.faces.empty()) return;
  std::string text = fmt::format("{}: no triangle with an area in it", name);
  for (const std::string& note : file.report.notes) text.append("; ").append(note);
  throw InputError(text);
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
  require_triangles(path.string(), file);
  return file;
}

void say_dropped(MeshReadReport& report, std::size_t held) {
  if (report.degenerate_faces > 0)
    report.notes.push_back(
        fmt::format("{} of {} triangles have no area and were left out", report.degenerate_faces, held));
  if (report.duplicate_faces > 0)
    report.notes.push_back(
        fmt::format("{} of {} triangles are there more than once and count once", report.duplicate_faces, held));
}

}  // namespace

double scale_of(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kCentimetre:
      return 10.0;
    case LengthUnit::kInch:
      return 25.4;
    case LengthUnit::kMetre:
      return 1000.0;
    case LengthUnit::kMillimetre:
      break;
  }
  return 1.0;
}

namespace {

std::string shown_name(const std::filesystem::path& path) {
  return path == "-" ? "standard input" : path.string();
}

MeshFile read_any_size(const std::filesystem::path& path, std::optional<LengthUnit> unit, const std::string& object,
                       const cad::FaceSelection& faces) {
  const std::string name = shown_name(path);
  const std::string read = read_file(path);  // Once, because it may be a pipe.
  if (cad::is_cad_file(path, read)) return read_part_mesh(path, read, unit, with_body(faces, object));
  if (!faces.is_empty())
    throw InputError(
        fmt::format("{}: only STEP and IGES files have faces to choose; leave the options for faces out", name));
  const std::string bytes = without_utf16(read);
  if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty", name));
  if (const std::string what = not_asked_for(bytes, FileUse::kMesh, name); !what.empty())
    throw InputError(fmt::format("{}: is {}", name, what));
  MeshFile file;
  ObjectFilter objects{object, {}};
  const MeshSource source{bytes, name, folder_of(path), objects, file.report.notes};
  MeshInUnit in_unit = read_as(format_of(source, extension_of(path)), source);
  file.mesh = std::move(in_unit.mesh);
  file.report.unit_from_file = in_unit.unit_mm > 0.0;
  if (file.report.unit_from_file) file.report.scale_to_mm = in_unit.unit_mm;
  require_object(name, objects);
  if (unit) file.report.scale_to_mm = scale_of(*unit);
  require_bounded(name, file.mesh, file.report.scale_to_mm);
  for (Vec3& v : file.mesh.vertices) v *= file.report.scale_to_mm;
  const std::size_t held = file.mesh.faces.size();
  clean(file.mesh, file.report);
  say_dropped(file.report, held);
  if (const auto place_mm = one_sided_at(file.mesh)) {
    file.report.notes.push_back(
        fmt::format("has only one side, as a Möbius strip has: there is no outside, and modules would lie on what is "
                    "both; it was cut open near ({:.1f}, {:.1f}, {:.1f}) mm",
                    place_mm->x(), place_mm->y(), place_mm->z()));
  }
  require_triangles(name, file);
  return file;
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit, const std::string& object,
                   const cad::FaceSelection& faces) {
  MeshFile file = read_any_size(path, unit, object, faces);
  require_size(shown_name(path), file.mesh, file.report.scale_to_mm, unit.has_value(), file.report.unit_from_file);
  return file;
}

Mesh read_body(const std::filesystem::path& path, std::optional<LengthUnit> unit, const std::string& object) {
  return read_any_size(path, unit, object, {}).mesh;
}

Mesh read_obj_group(const std::filesystem::path& path, const std::string& group, double scale_to_mm) {
  if (extension_of(path) != ".obj")
    throw InputError(fmt::format("{}: only OBJ files have named groups; give faces, a sphere or a box", path.string()));
  ObjectFilter objects{group, {}};
  std::vector<std::string> notes;
  const std::string bytes = without_utf16(read_file(path));
  Mesh mesh = read_obj({bytes, path.string(), {}, objects, notes});
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

namespace {

// Text keeps double precision; the binary form keeps single precision only.
void write_text_stl(const std::filesystem::path& path, const Mesh& mesh) {
  std::string text = "solid triskin\n";
  for (const auto& f : mesh.faces) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(f[k])]; };
    const Vec3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    text += fmt::format("facet normal {} {} {}\nouter loop\n", n.x(), n.y(), n.z());
    for (std::size_t k = 0; k < 3; ++k)
      text += fmt::format("vertex {} {} {}\n", corner(k).x(), corner(k).y(), corner(k).z());
    text += "endloop\nendfacet\n";
  }
  write_output(path, text + "endsolid triskin\n");
}

}  // namespace

void require_mesh_output(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  std::error_code none;
  const auto status = std::filesystem::status(path, none);
  const bool is_file = !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
  if (path == "-" || !is_file || extension.empty() || extension == ".obj" || extension == ".stl") return;
  throw InputError(
      fmt::format("{}: a mesh is written as OBJ or STL; give a name that ends with .obj or .stl", path.string()));
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  require_mesh_output(path);
  if (extension_of(path) == ".stl") return write_text_stl(path, mesh);
  write_obj(path, mesh);
}

}  // namespace triskin::mesh
