// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fmt/format.h>

#include "command.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::cli {

/// Adds --corner-cut-mm, 0 … design::kMaxCornerCut_mm.
inline void add_corner_cut(CLI::App& app, double& corner_cut_mm) {
  app.add_option("--corner-cut-mm", corner_cut_mm,
                 "cut off along each side from every corner of a module; above 6.9 taxels would be cut off")
      ->check(CLI::Range(0.0, design::kMaxCornerCut_mm))
      ->capture_default_str();
}

/// Warns if a cut is nearer to taxels than the sides of the module are.
inline void say_cut_pads(double corner_cut_mm, Output& output) {
  if (corner_cut_mm <= design::kHarmlessCornerCut_mm) return;
  output.say(
      fmt::format("above {} mm the cut comes nearer than 3 mm to the centres of taxels 1, 5 and 9: mind their pads",
                  design::kHarmlessCornerCut_mm));
}

}  // namespace triskin::cli
