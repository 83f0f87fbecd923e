// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "document.hpp"
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

struct BuildOptions {
  double unit_mm = 0.0;            ///< One unit of the file has this length; 0 uses the unit that the file states.
  double max_deviation_mm = 0.05;  ///< The value must be positive.
};

/// Meshes every body separately and records the facts of its faces. Errors: std::runtime_error with a sentence if no
/// face remains.
[[nodiscard]] cad::Part build_part(const Document& document, const BuildOptions& options, const StageSink& stage);

}  // namespace triskin::cad_reader
