// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"

namespace triskin::test {

/// A design without modules on the rectangle from `low_mm` to `high_mm` of the plane z = 0.
inline design::Design flat_design(const std::string& name, const design::Vec2& low_mm, const design::Vec2& high_mm) {
  design::Design d;
  d.name = name;
  d.source_file = name + ".obj";
  d.surface.vertices = {{low_mm.x(), low_mm.y(), 0},
                        {high_mm.x(), low_mm.y(), 0},
                        {high_mm.x(), high_mm.y(), 0},
                        {low_mm.x(), high_mm.y(), 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  d.layout.islands = 1;
  d.layout.method = design::LayoutMethod::kSurface;
  return d;
}

}  // namespace triskin::test
