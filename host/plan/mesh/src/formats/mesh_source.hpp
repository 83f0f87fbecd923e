// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "object_filter.hpp"
#include "triskin/base/short_list.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Passes a mesh file in memory to the reader of its format.
struct MeshSource {
  const std::string& bytes;  ///< Text is already converted to UTF-8.
  std::string name;          ///< Messages call the file by this name.
  /// Files that the mesh refers to are looked for in this folder. It is empty for a mesh from a pipe, which can refer
  /// to no file.
  std::filesystem::path folder;
  ObjectFilter& objects;
  /// Each note is a sentence for the user about something that may be missing or was left out.
  std::vector<std::string>& notes;
};

/// Returns the note about nodes or items of a file whose transform has a determinant of 0.
[[nodiscard]] inline std::string flattened_note(std::size_t count) {
  return std::to_string(count) + " of its shown meshes are flattened by a scale of 0 in the file";
}

/// Returns the note about objects that their author switched off. Ranges of triangles have no name for --object.
[[nodiscard]] inline std::string hidden_note(const std::vector<std::string>& names, bool have_ranges = false) {
  return "switched off in the file and left out: " + short_list(names, 5) +
         (have_ranges ? "" : "; --object takes one of them");
}

/// Faces in the unit of their file, and that unit.
struct MeshInUnit {
  Mesh mesh;
  double unit_mm = 0.0;  ///< The file or its format states this unit; 0 means that neither does.
};

}  // namespace triskin::mesh
