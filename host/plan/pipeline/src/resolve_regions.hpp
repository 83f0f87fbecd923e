// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>

#include "triskin/design/region_file.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::pipeline {

/// Resolves regions for the surface of a mesh file that was read in `unit`: groups and faces of the file become faces
/// of the surface, and obstacles get their meshes from this file or from others, each in its own unit.
/// Errors: InputError naming the region for groups and faces that are not there, that do not belong to the surface, and
/// for any of them where the mesh had to be repaired, so that its faces are others. Cost: O(faces) a region of faces.
[[nodiscard]] design::Regions resolve_regions(const std::filesystem::path& mesh, std::optional<mesh::LengthUnit> unit,
                                              const mesh::MeshFile& file, const mesh::Extraction& surface,
                                              const design::RegionFile& wanted);

}  // namespace triskin::pipeline
