// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::fabrication {

/// Writes the cover ("cover", a shell of plane faces as its mesh has them) and the modules (solids M<id>) as a STEP
/// assembly. A cover of more than 20,000 faces is left out, with a sentence in `left_out`. Errors: as
/// cad::write_step().
[[nodiscard]] std::string assembly_step(const design::Design& design, double corner_cut_mm,
                                        std::vector<std::string>& left_out);

}  // namespace triskin::fabrication
