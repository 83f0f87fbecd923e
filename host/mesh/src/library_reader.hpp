// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "object_filter.hpp"
#include "three_mf_reader.hpp"

namespace triskin::geometry {

/// Reads a file with assimp (DAE, glTF, GLB and what else it knows) in a child process, `bytes` is its content;
/// objects are the nodes of the scene, by their own or their mesh's name. Errors: InputError naming the file where it
/// cannot be read, and where the library crashes or does not end.
[[nodiscard]] MeshInUnit read_with_library(const std::filesystem::path& path, const std::string& bytes,
                                           ObjectFilter& objects);

}  // namespace triskin::geometry
