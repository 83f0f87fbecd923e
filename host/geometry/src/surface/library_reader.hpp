// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "object_filter.hpp"
#include "triskin/geometry/design_types.hpp"

namespace triskin::geometry {

/// What the library gave: faces in the unit of the file.
struct LibraryMesh {
  Mesh mesh;
  double unit_mm = 0.0;  ///< that the file or its format says; 0: none
};

/// Reads a file with assimp (DAE, glTF, GLB, 3MF and what else it knows) in a child process, `bytes` is its content;
/// objects are the nodes of the scene, by their own or their mesh's name. Errors: InputError naming the file where it
/// cannot be read, and where the library crashes or does not end.
[[nodiscard]] LibraryMesh read_with_library(const std::filesystem::path& path, const std::string& bytes,
                                            ObjectFilter& objects);

}  // namespace triskin::geometry
