// SPDX-License-Identifier: GPL-3.0-or-later
#include "assembly.hpp"

#include <fmt/format.h>

#include "solids.hpp"
#include "triskin/cad/write_step.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/fabrication/flat_island.hpp"

namespace triskin::fabrication {
namespace {

constexpr std::size_t kMaxCoverFaces = 20'000;  // Each face takes about a millisecond and 2 kB of the file.

cad::StepBody cover_body(const design::Mesh& surface) {
  cad::StepBody body{"cover", {180, 180, 180}, surface.vertices, {}};
  for (const auto& [a, b, c] : surface.faces) body.faces.push_back({a, b, c});
  return body;
}

// A prism keeps its plane faces: lower and upper outline, and one quadrilateral per side.
cad::StepBody module_body(const Solid& solid) {
  cad::StepBody body{solid.name, solid.colour, solid.mesh.vertices, {}};
  const int n = static_cast<int>(solid.mesh.vertices.size()) / 2;
  std::vector<int> lower, upper;
  for (int k = 0; k < n; ++k) {
    lower.push_back(n - 1 - k);
    upper.push_back(n + k);
    body.faces.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
  }
  body.faces.push_back(std::move(lower));
  body.faces.push_back(std::move(upper));
  return body;
}

}  // namespace

std::string assembly_step(const design::Design& design, double corner_cut_mm, std::vector<std::string>& left_out) {
  std::vector<cad::StepBody> bodies;
  if (design.surface.faces.size() <= kMaxCoverFaces) {
    bodies.push_back(cover_body(design.surface));
  } else {
    left_out.push_back(
        fmt::format("the cover is not in the STEP assembly: it has {} faces, and {} are what a CAD program "
                    "bears; use the STEP file of the part itself",
                    design.surface.faces.size(), kMaxCoverFaces));
  }
  for (const Solid& solid : module_solids(design, corner_cut_mm)) bodies.push_back(module_body(solid));
  return cad::write_step(plain_name(design.name), bodies);
}

}  // namespace triskin::fabrication
