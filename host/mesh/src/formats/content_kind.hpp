// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin::geometry {

/// Formats that read_mesh() reads.
enum class MeshFormat { kObj, kTextStl, kBinaryStl, kPly, kOff, kThreeMf, kGltf, kDae, kLibrary, kUnknown };

/// Name of a format for messages: "OBJ", "STL" …
[[nodiscard]] std::string_view name_of(MeshFormat format);

/// The format that the bytes themselves show, whatever the file is called; kUnknown where they show none. Cost: linear
/// in the first kilobytes.
[[nodiscard]] MeshFormat format_by_content(const std::string& bytes);

/// The format that a file's extension (lower case, with the dot) stands for; kUnknown for an empty or unknown one.
[[nodiscard]] MeshFormat format_by_extension(std::string_view extension);

/// What bytes are that are no mesh, with what to do: "a pointer of Git LFS; run git lfs pull". Empty where they may be
/// a mesh. Cost: as format_by_content().
[[nodiscard]] std::string foreign_content(const std::string& bytes);

}  // namespace triskin::geometry
