// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "triskin/check/design_rules.hpp"
#include "triskin/design/mesh.hpp"

namespace triskin::check {

/// Makes a sheet of columns × rows cells of two triangles; place(c, r) is corner (c, r), 0 … columns, 0 … rows.
design::Mesh sheet_mesh(int columns, int rows, const auto& place) {
  design::Mesh mesh;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) mesh.vertices.push_back(place(c, r));
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int v = r * (columns + 1) + c;
      mesh.faces.push_back({v, v + 1, v + columns + 1});
      mesh.faces.push_back({v + 1, v + columns + 2, v + columns + 1});
    }
  }
  return mesh;
}

/// Writes a design file with this content to `file` and returns the findings of `check`.
inline std::vector<Violation> violations_of(const nlohmann::json& design, const std::filesystem::path& file) {
  std::ofstream(file) << design.dump();
  return check_design(file).violations;
}
/// Returns the names of the rules that it breaks, one for each violation.
inline std::vector<std::string> broken_rules(const nlohmann::json& design, const std::filesystem::path& file) {
  std::vector<std::string> names;
  for (const Violation& v : violations_of(design, file)) names.push_back(v.rule);
  return names;
}

}  // namespace triskin::check
