// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace triskin::check {

/// One broken rule.
struct Violation {
  std::string rule;   ///< docs/check.md lists the names.
  std::string where;  ///< It is "module 12", "module 3 side 1", "patch 0", "piece 2" or "design".
  std::string text;   ///< It compares the measured number with the limit.
};

/// Result of a check: the design keeps all rules when `violations` is empty.
struct DesignReport {
  std::size_t modules = 0;         ///< It counts the modules of the design; without any, no rule can be broken.
  std::vector<std::string> rules;  ///< It lists every rule that was checked.
  std::vector<Violation> violations;
  /// Each limit that the file states and that was checked has its name and value.
  std::vector<std::pair<std::string, double>> limits;
  double corner_cut_mm = 0.0;  ///< The modules measured had this corner cut; 0 means whole triangles.
};

/// Checks every rule of a design file against the mesh that the file holds. Shares no code with the solvers: own
/// reader, own geometry (CGAL's exact predicates and its tree of triangles). Errors: InputError when the file cannot be
/// read as a design; broken rules are no errors but violations. One thread; thread-safe. Cost: about 300 closest-point
/// queries a module, some hundred more at the border.
[[nodiscard]] DesignReport check_design(const std::filesystem::path& path);

}  // namespace triskin::check
