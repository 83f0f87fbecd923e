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
  std::filesystem::path file;  ///< It holds the mesh of an obstacle; if it is empty, the file of the part does.
  std::string object;          ///< It names one object or body of that file; if it is empty, all of it counts.
};

/// docs/regions.md describes the contents of a region file.
struct RegionFile {
  double elsewhere = 1.0;
  std::vector<WantedRegion> regions;
};

/// Reads one and checks its form; ranges are for geometry::SurfaceRegions to check, which knows the surface. Files that
/// it names are taken from its own folder. Errors: InputError naming file and key, also for keys that are unknown.
/// Cost: linear.
[[nodiscard]] RegionFile read_region_file(const std::filesystem::path& path);

}  // namespace triskin::design
