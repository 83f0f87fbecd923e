// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "triskin/mechanics/contact.hpp"

namespace triskin::mechanics {

/// Gives the worst relative errors of one level against the exact solution. The error of a taxel is relative to the
/// peak of ΔC/C.
struct LevelErrors {
  double indentation = 0.0, contact_radius = 0.0, peak_pressure = 0.0, taxel = 0.0;
  int refused = 0;  ///< The exact solution has an answer for these contacts, but this level has none.
};

/// Gives the errors of the levels winkler, log and table for contacts of one Poisson's ratio and one range of contact
/// radii.
struct ComparisonRow {
  std::string indenter;
  double poisson = 0.0;
  double min_ratio = 0.0, max_ratio = 0.0;  ///< The contact radii are in thicknesses of the layer.
  int contacts = 0;
  std::array<LevelErrors, 3> levels;
};

/// Gives the median cost of one contact by a level, in microseconds.
struct LevelCost {
  std::string level;
  double microseconds = 0.0;
};

/// Compares the grid of layer_patch.hpp with the exact solution of a sphere.
struct PatchRow {
  double poisson = 0.0, points_per_radius = 0.0;
  int points = 0;  ///< The patch has this many points per side.
  double milliseconds = 0.0;
  LevelErrors errors;
};

struct Comparison {
  std::vector<ComparisonRow> rows;
  std::vector<LevelCost> costs;
  std::vector<PatchRow> patches;
  double table_seconds = 0.0;  ///< Making the table of one Poisson's ratio takes this long.
  int contacts = 0;            ///< The exact solution answered this many contacts.
  int left_out = 0;            ///< These contacts would press the layer to more than 0.6 of its thickness.
};

/// Compares the levels on spheres of 3 … 50 mm, flat punches and lines, 0.1 … 20 N, layers of 1 … 3 mm, ν 0.1
/// … 0.45, E 100 kPa. Cost: some 10 s.
[[nodiscard]] Comparison compare_levels();

/// Writes the comparison as Markdown tables.
[[nodiscard]] std::string comparison_text(const Comparison& comparison);

}  // namespace triskin::mechanics
