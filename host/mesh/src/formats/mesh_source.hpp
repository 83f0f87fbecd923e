// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "object_filter.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// A mesh file that is in memory, for the reader of its format.
struct MeshSource {
  const std::string& bytes;  ///< Text is in UTF-8 when it arrives here.
  std::string name;          ///< Messages call the file by this name.
  /// Folder in which files beside it are looked for; empty: it came from a pipe, there are none.
  std::filesystem::path folder;
  ObjectFilter& objects;
  std::vector<std::string>& notes;  ///< Each is a sentence for the user about what may be missing or was left out.
};

/// Faces in the unit of a file, and that unit.
struct MeshInUnit {
  Mesh mesh;
  double unit_mm = 0.0;  ///< The file or its format says this unit; 0 means neither does.
};

}  // namespace triskin::geometry
