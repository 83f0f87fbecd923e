// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Reads an OFF file (also COFF and NOFF: what follows a vertex or face on its line is left alone). Polygons become
/// fans. Every count and index is checked. Throws InputError naming `file` and the line.
[[nodiscard]] Mesh read_off(const std::string& text, const std::string& file);

}  // namespace triskin::geometry
