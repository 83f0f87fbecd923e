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
  const std::string& bytes;  ///< text is UTF-8
  std::string name;          ///< name for messages
  /// Folder in which files beside it are looked for; empty: it came from a pipe, there are none.
  std::filesystem::path folder;
  ObjectFilter& objects;
  std::vector<std::string>& notes;  ///< sentences for the user: what may be missing, what was left out
};

/// Faces in the unit of a file, and that unit.
struct MeshInUnit {
  Mesh mesh;
  double unit_mm = 0.0;  ///< unit that the file or its format says; 0: none
};

}  // namespace triskin::geometry
