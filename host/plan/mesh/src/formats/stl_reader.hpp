// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "mesh_source.hpp"

namespace triskin::mesh {

/// Recognises binary STL. The length must fit the count at byte 80, whatever the first word says; another length is
/// accepted if the file is not text that begins with "solid" or a facet.
[[nodiscard]] bool is_binary_stl(const std::string& bytes);
/// Reads the triangles of a binary STL. A count of 0 or 2³² − 1, as programs that write to a pipe leave it, is
/// replaced by the number in the file, with a note; bytes behind the last triangle give a note too. Errors: InputError
/// if the file holds fewer triangles than its count. Cost: linear.
[[nodiscard]] Mesh read_binary_stl(const MeshSource& source);
/// Reads the triangles of a text STL in double precision, whatever its line breaks; objects are the names after
/// `solid`. Errors: InputError naming the broken line, and if the end of a solid is missing. Cost: linear.
[[nodiscard]] Mesh read_text_stl(const MeshSource& source);

}  // namespace triskin::mesh
