// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "object_filter.hpp"
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Faces in the unit of a file, and that unit.
struct MeshInUnit {
  Mesh mesh;
  double unit_mm = 0.0;  ///< that the file or its format says; 0: none
};

/// Reads a 3MF file: the items of its build with their transforms, components, models in other parts (production
/// extension), numbers in double precision. Objects are those of `name`, or of `id` where they have none. The unit is
/// millimetre where the file states none, as the standard says. Errors: InputError naming the file and what is wrong.
/// Cost: linear in the faces that the build shows.
[[nodiscard]] MeshInUnit read_3mf(const std::filesystem::path& path, ObjectFilter& objects);

}  // namespace triskin::geometry
