// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "triskin/design/regions.hpp"

namespace triskin::design {

/// A person writes a region in this form; faces are numbered as triangles of the mesh file, or belong to a named group.
struct WantedRegion {
  Region region;
  std::string group;  ///< It names a group or object of an OBJ file; if it is empty, the shape of `region` says it.
  std::filesystem::path file;  ///< The mesh of an obstacle is in this file; an empty path means the part's own file.
  std::string object;  ///< The obstacle is this object or body of the file; an empty name selects the whole file.
};

/// docs/regions.md describes the contents of a region file.
struct RegionFile {
  double elsewhere = 1.0;
  std::vector<WantedRegion> regions;
};

/// Reads a region file and checks its form; mesh::SurfaceRegions, which knows the surface, checks the ranges.
/// Relative paths in it start at its own folder. Errors: InputError naming file and key, also for keys that are
/// unknown. Cost: linear.
[[nodiscard]] RegionFile read_region_file(const std::filesystem::path& path);

}  // namespace triskin::design
