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
  std::vector<int> faces;             ///< The chosen faces are named by their index in the part.
  int face_count = 0;                 ///< The part has so many faces.
  double deviation_mm = 0.0;          ///< It is the mesh's largest deviation from the exact surface.
  std::vector<std::string> warnings;  ///< Each warning is one sentence.
  /// Each fault is one sentence about something in the file that is missing or wrong.
  std::vector<std::string> faults;
};

/// Changes that reading made to the file's triangles, for the report.
struct MeshReadReport {
  double scale_to_mm = 1.0;
  /// The file said its unit (DAE, 3MF), or its format has one (glTF and GLB are in metres).
  bool unit_from_file = false;
  int welded_vertices = 0;   ///< Corners at the same place, within 1e-7 of the size, became one vertex.
  int degenerate_faces = 0;  ///< Faces without area were dropped.
  int duplicate_faces = 0;   ///< Faces with the same three vertices as an earlier one were dropped.
  int flipped_faces = 0;     ///< Faces were turned so that neighbours agree.
  /// Each note tells the user what may be missing or was left out, as a sentence without a subject.
  std::vector<std::string> notes;
  std::optional<PartReport> part;  ///< It is there only for STEP and IGES files.
};

/// Result of read_mesh().
struct MeshFile {
  Mesh mesh;  ///< It is in mm and oriented as in the file, without coincident vertices, degenerate or double faces.
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

/// The same for a body that need not be a part, as a screw or another part of an assembly: it may have any size.
[[nodiscard]] Mesh read_body(const std::filesystem::path& path, std::optional<LengthUnit> unit = std::nullopt,
                             const std::string& object = {});

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
