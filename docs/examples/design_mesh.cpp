// SPDX-License-Identifier: GPL-3.0-or-later
// Designs the skin of a mesh in five seconds and lists its modules. Usage: design_mesh MESH DESIGN
#include <cstdio>
#include <exception>

#include "triskin/design/design.hpp"
#include "triskin/pipeline/make_design.hpp"

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  triskin::pipeline::DesignOptions options;
  options.time_limit_s = 5.0;
  const triskin::design::Design design = triskin::pipeline::make_design(argv[1], options).design;
  triskin::design::write_design(argv[2], design);
  const auto wiring = triskin::design::wiring_of(design);
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const auto& corner = design.layout.modules[m].corner_mm;
    const triskin::design::Vec3 centre_mm = (corner[0] + corner[1] + corner[2]) / 3.0;
    std::printf("module %zu at (%.1f, %.1f, %.1f) mm: controller %d, line %d, address %d\n", m, centre_mm.x(),
                centre_mm.y(), centre_mm.z(), wiring[m].patch.value(), wiring[m].routed.line, wiring[m].routed.address);
  }
  std::printf("%zu modules, %zu controllers\n", design.layout.modules.size(), design.patches.size());
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}
