// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/cad/select_faces.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Unit of the numbers in a mesh file.
enum class LengthUnit { kMillimetre, kCentimetre, kInch, kMetre };
/// Length of one unit in mm: 1, 10, 25.4 or 1000.
[[nodiscard]] double scale_of(LengthUnit unit);

/// What reading a CAD file gave beside its mesh.
struct PartReport {
  std::vector<int> faces;             ///< chosen, by their index in the part
  int face_count = 0;                 ///< number of faces of the part
  double deviation_mm = 0.0;          ///< largest, of the mesh from the exact surface
  std::vector<std::string> warnings;  ///< one sentence each
  std::vector<std::string> faults;    ///< one sentence each: something of the file is missing or not right
};

/// Changes that reading made to the file's triangles, for the report.
struct MeshReadReport {
  double scale_to_mm = 1.0;
  bool unit_from_file = false;     ///< the file said its unit (DAE, 3MF), or its format has one (glTF, GLB: metres)
  int welded_vertices = 0;         ///< corners at the same place that became one vertex (relative 1e-7 of the size)
  int degenerate_faces = 0;        ///< faces without area, dropped
  int duplicate_faces = 0;         ///< faces with the same three vertices as an earlier one, dropped
  int flipped_faces = 0;           ///< faces turned so that neighbours agree
  std::vector<std::string> notes;  ///< sentences without a subject for the user: what may be missing, what was left out
  std::optional<PartReport> part;  ///< only for STEP and IGES files
};

/// Result of read_mesh().
struct MeshFile {
  Mesh mesh;  ///< mm; coincident vertices welded; no degenerate or duplicate face; orientation as in the file
  MeshReadReport report;
};

/// Reads OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF, STEP or IGES, each in its own frame (docs/mesh_files.md) and, DAE
/// aside, in the precision of the file. The content says the format; a name that says another one is a note. `path` may
/// be a pipe or "-" (standard input): the file is read once, from memory. Without `unit` the file's numbers are mm, or
/// in the unit of the file (DAE, 3MF) or format (glTF, GLB: m). With `object` the faces of one object alone: `o` and
/// `g` of OBJ, `solid` of a text STL, nodes and meshes of DAE, glTF, GLB and 3MF. Errors: InputError naming the file
/// for what is no mesh (saying what it is), for files that are empty, cut, damaged or without a face, for coordinates
/// that are not finite or beyond ±1e10 mm, for sizes that cannot be a body part (under 20 mm, with the units that fit;
/// over 5 m), over 3 m where nobody said the unit, and for an object that is not in it, naming those that are. Cost:
/// O(n log n). Thread-safe. DAE is read by a library in a child process: a crash of it is an InputError. Of STEP and
/// IGES files (docs/cad.md) the mesh is that of the faces chosen by `faces`, `object` is a body, and corners of
/// different bodies are not welded; choosing faces in a file of another format is an InputError.
[[nodiscard]] MeshFile read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit = std::nullopt,
                                 const std::string& object = {}, const cad::FaceSelection& faces = {});

/// The triangles of one group or object (`g`, `o`) of an OBJ file, as read_mesh() has them. Errors: InputError for
/// other files and for a name that is not in it, naming those that are. Cost: linear.
[[nodiscard]] Mesh read_obj_group(const std::filesystem::path& path, const std::string& group, double scale_to_mm);

/// Writes vertices (mm) and faces as OBJ, whole or not at all. Errors: InputError naming the file when it cannot be
/// written. Cost: linear.
void write_obj(const std::filesystem::path& path, const Mesh& mesh);

/// Throws InputError where write_mesh() would for the name of the file.
void require_mesh_output(const std::filesystem::path& path);
/// Writes vertices (mm) and faces as the extension of `path` says: .stl as text STL, .obj, none, a device or "-" as
/// OBJ; whole or not at all, every coordinate to the last bit. Errors: InputError naming the file when it cannot be
/// written, and for other extensions. Cost: linear.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace triskin::geometry
