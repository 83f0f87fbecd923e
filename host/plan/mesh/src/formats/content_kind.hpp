// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace triskin::mesh {

enum class MeshFormat { kObj, kTextStl, kBinaryStl, kPly, kOff, kThreeMf, kGltf, kDae, kUnknown };

/// Returns the name of a format for messages: "OBJ", "STL" …
[[nodiscard]] std::string_view name_of(MeshFormat format);

/// Recognises a format by the bytes alone, whatever the file is called; kUnknown if they fit none. Cost: linear in the
/// first kilobytes.
[[nodiscard]] MeshFormat format_by_content(const std::string& bytes);

/// Returns the format of a file extension (lower case, with the dot); kUnknown for an empty or unknown one.
[[nodiscard]] MeshFormat format_by_extension(std::string_view extension);

}  // namespace triskin::mesh
