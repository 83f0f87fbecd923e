// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "triskin/design/region_file.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::pipeline {

/// Maps regions to the surface that was made of a mesh file: groups and faces of the file become faces of the surface.
/// Errors: InputError naming the region for groups and faces that do not exist or do not belong to the surface, and for
/// any of them if the mesh had to be repaired, which changes its faces. Cost: O(faces) per region of faces.
[[nodiscard]] design::Regions resolve_regions(const std::filesystem::path& mesh, const geometry::MeshFile& file,
                                              const geometry::Extraction& surface, const design::RegionFile& wanted);

}  // namespace triskin::pipeline
