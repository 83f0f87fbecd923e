// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "object_filter.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Vertices and faces of a Wavefront OBJ text in double precision: polygons, indices from the end, continued lines;
/// what is no surface is skipped. Errors: InputError naming `file` and the line. Cost: linear.
/// Objects are those of `o` (the rest of the line) and groups of `g` (each word).
[[nodiscard]] Mesh read_obj(const std::string& text, const std::string& file, ObjectFilter& objects);

/// Does a file hold binary STL? Its length is that of the count at byte 80, whatever its first word says; a longer file
/// counts where it does not begin with "solid" and a facet.
[[nodiscard]] bool is_binary_stl(const std::string& bytes);
/// Triangles of a binary STL. A count too large for the file is replaced by what the file holds. Cost: linear.
[[nodiscard]] Mesh read_binary_stl(const std::string& bytes);
/// Triangles of a text STL in double precision; objects are the names after `solid`. Errors: InputError naming `file`
/// and the line of a broken vertex, or that it is not STL. Cost: linear.
[[nodiscard]] Mesh read_text_stl(const std::string& text, const std::string& file, ObjectFilter& objects);

}  // namespace triskin::geometry
