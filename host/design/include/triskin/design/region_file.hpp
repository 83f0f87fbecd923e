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
  std::string group;  ///< The group or object of an OBJ file has this name; if it is empty, `region` has the shape.
};

/// docs/regions.md describes the contents of a region file.
struct RegionFile {
  double elsewhere = 1.0;
  std::vector<WantedRegion> regions;
};

/// Reads a region file and checks its form; geometry::SurfaceRegions checks ranges, because it knows the surface.
/// Errors: InputError naming file and key, also for unknown keys. Cost: linear.
[[nodiscard]] RegionFile read_region_file(const std::filesystem::path& path);

}  // namespace triskin::design
