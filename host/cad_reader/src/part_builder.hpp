// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "document.hpp"
#include "triskin/cad/part.hpp"

namespace triskin::cad_reader {

/// How a part is meshed.
struct BuildOptions {
  double unit_mm = 0.0;            ///< It is the length of one unit in the file; 0 means that the file says it.
  double max_deviation_mm = 0.05;  ///< It must be positive.
};

/// Meshes every body for itself and writes down what is to be known of its faces. Errors: std::runtime_error with a
/// sentence where no face is left.
[[nodiscard]] cad::Part build_part(const Document& document, const BuildOptions& options, const StageSink& stage);

}  // namespace triskin::cad_reader
