// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "mesh_source.hpp"

namespace triskin::geometry {

/// Does a file hold binary STL? Its length is that of the count at byte 80, whatever its first word says; another
/// length counts where the file is not text that begins with "solid" or a facet.
[[nodiscard]] bool is_binary_stl(const std::string& bytes);
/// Triangles of a binary STL. A count of 0 or 2³² − 1, as programs leave it that write to a pipe, is replaced by
/// what the file holds, with a note; so are bytes behind the last triangle. Errors: InputError where the file holds
/// fewer triangles than its count. Cost: linear.
[[nodiscard]] Mesh read_binary_stl(const MeshSource& source);
/// Triangles of a text STL in double precision, in lines or not; objects are the names after `solid`. Errors:
/// InputError naming the line of what is broken, and where the end of a solid is missing. Cost: linear.
[[nodiscard]] Mesh read_text_stl(const MeshSource& source);

}  // namespace triskin::geometry
