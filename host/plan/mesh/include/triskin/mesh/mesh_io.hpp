// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "triskin/cad/select_faces.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

enum class LengthUnit { kMillimetre, kCentimetre, kInch, kMetre };
/// Returns the length of one unit in mm: 1, 10, 25.4 or 1000.
[[nodiscard]] double scale_of(LengthUnit unit);

/// Reports what a CAD file says beside its mesh.
struct PartReport {
  std::vector<design::BrepFaceIndex> faces;  ///< These faces of the part were chosen.
  int face_count = 0;
  double deviation_mm = 0.0;          ///< No point of the mesh is farther than this from the exact surface.
  std::vector<std::string> warnings;  ///< Each warning is one sentence.
  /// Each fault is one sentence about something in the file that is missing or wrong.
  std::vector<std::string> faults;
};

/// Counts the changes that reading made to the triangles of the file.
struct MeshReadReport {
  double scale_to_mm = 1.0;
  /// True if the file states its unit (DAE, 3MF) or its format has one (glTF and GLB are in metres).
  bool unit_from_file = false;
  int welded_vertices = 0;   ///< Corners at the same place, within 1e-7 of the size, became one vertex.
  int joined_corners = 0;    ///< Corners that lay on an edge of another face (T-junctions) now divide it.
  int degenerate_faces = 0;  ///< Faces without area were dropped.
  int duplicate_faces = 0;   ///< Faces with the same three vertices as an earlier one were dropped.
  int flipped_faces = 0;     ///< These faces were turned so that neighbours agree.
  /// Each note tells the user what may be missing or was left out, as a sentence without a subject.
  std::vector<std::string> notes;
  std::optional<PartReport> part;  ///< Only STEP and IGES files have this report.
};

struct MeshFile {
  /// Lengths are in mm, and faces are oriented as in the file; coincident vertices, degenerate and double faces are
  /// already removed.
  Mesh mesh;
  MeshReadReport report;
};

/// Reads OBJ, STL, PLY, OFF, DAE, glTF, GLB, 3MF, STEP or IGES, each in its own frame (docs/mesh.md) and, except
/// DAE, in the precision of the file. The content decides the format; a name that says another one gives a note. `path`
/// may be a pipe or "-" (standard input): the file is read once, from memory. Without `unit` the file's numbers are mm,
/// or in the unit of the file (DAE, 3MF) or format (glTF, GLB: m). With `object` only the faces of one object are read:
/// `o` and `g` of OBJ, `solid` of a text STL, nodes and meshes of DAE, glTF, GLB and 3MF. Errors: InputError naming the
/// file if it is no mesh (saying what it is), empty, cut, damaged or without a face; for coordinates that are not
/// finite or beyond ±1e10 mm; for sizes that cannot be a body part (under 20 mm, with the units that fit; over 5 m),
/// or over 1.5 m unless --unit answers; and for an object that does not exist, naming those that do. Cost: O(n log
/// n). Thread-safe. A library reads DAE in a child process, and a crash of it is an InputError. For STEP and IGES files
/// (docs/cad.md) the mesh has the faces chosen by `faces`, `object` is a body, and corners of different bodies are not
/// welded; choosing faces in a file of another format is an InputError.
[[nodiscard]] MeshFile read_mesh(const std::filesystem::path& path, std::optional<LengthUnit> unit = std::nullopt,
                                 const std::string& object = {}, const cad::FaceSelection& faces = {});

/// Reads a mesh without the limits on a part's size, for example a screw or another part of an assembly.
[[nodiscard]] Mesh read_body(const std::filesystem::path& path, std::optional<LengthUnit> unit = std::nullopt,
                             const std::string& object = {});

/// The triangles of one group or object (`g`, `o`) of an OBJ file, as read_mesh() has them. Errors: InputError for
/// other files and for a name that is not in it, naming those that are. Cost: linear.
[[nodiscard]] Mesh read_obj_group(const std::filesystem::path& path, const std::string& group, double scale_to_mm);

/// Writes vertices (mm) and faces as OBJ; a failure leaves no partial file. Errors: InputError naming the file when it
/// cannot be written. Cost: linear.
void write_obj(const std::filesystem::path& path, const Mesh& mesh);

/// Throws InputError if write_mesh() would refuse the name of the file.
void require_mesh_output(const std::filesystem::path& path);
/// Writes vertices (mm) and faces in the format of the extension: .stl as text STL; .obj, no extension, a device or "-"
/// as OBJ. Every coordinate keeps its last bit, and a failure leaves no partial file. Errors: InputError naming the
/// file when it cannot be written, and for other extensions. Cost: linear.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

}  // namespace triskin::mesh
