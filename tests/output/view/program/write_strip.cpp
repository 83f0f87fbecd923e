// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a strip of modules as a design file. Usage: write_strip FILE MODULES [MODULES_A_PATCH]
#include <cstdlib>

#include "support/strip_design.hpp"
#include "triskin/geometry/triangle.hpp"

namespace {

using triskin::design::Design, triskin::design::Patch, triskin::design::kModuleArea_mm2;

// States what `triskin check` computes anew, so that commands that write a design accept the strip.
void state_totals(Design& d) {
  for (Patch& patch : d.patches) {
    // The tree is a chain whose lines only increase: below module n are its own line and those up to the last one.
    patch.line_hops = 0;
    for (std::size_t n = 1; n < patch.modules.size(); ++n)
      patch.line_hops += patch.modules.back().line - patch.modules[n].line + 1;
  }
  double area_mm2 = 0.0;
  for (const auto& face : d.surface.faces) {
    const auto corner = [&](std::size_t k) { return d.surface.vertices[static_cast<std::size_t>(face[k])]; };
    area_mm2 += triskin::geometry::area_of({corner(0), corner(1), corner(2)});
  }
  d.report.area_cm2 = area_mm2 / 100.0;
  d.report.coverage = static_cast<double>(d.layout.modules.size()) * kModuleArea_mm2 / area_mm2;
  d.report.upper_bound = static_cast<int>(area_mm2 / kModuleArea_mm2);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) return 2;
  Design d = triskin::test::strip(std::atoi(argv[2]), argc == 4 ? std::atoi(argv[3]) : 16);
  state_totals(d);
  triskin::design::write_design(argv[1], d);
  return 0;
}
