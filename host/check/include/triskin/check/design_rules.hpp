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
  std::string rule;   ///< name as in docs/check.md
  std::string where;  ///< "module 12", "module 3 side 1", "patch 0", "piece 2", "design"
  std::string text;   ///< the measured number against the limit
};

/// Result of a check: the design keeps all rules when `violations` is empty.
struct DesignReport {
  std::size_t modules = 0;         ///< number of modules in the design; without any, no rule can be broken
  std::vector<std::string> rules;  ///< every rule that was checked
  std::vector<Violation> violations;
  std::vector<std::pair<std::string, double>> limits;  ///< name and value of each limit in the file that was checked
  double corner_cut_mm = 0.0;  ///< corner cut of the modules that were measured; 0: whole triangles
};

/// Checks every rule of a design file against the mesh that the file holds. Shares no code with the solvers: own
/// reader, own geometry (CGAL's exact predicates and its tree of triangles). Errors: InputError when the file cannot be
/// read as a design; broken rules are no errors but violations. One thread; thread-safe. Cost: about 300 closest-point
/// queries a module, some hundred more at the border.
[[nodiscard]] DesignReport check_design(const std::filesystem::path& path);

}  // namespace triskin::check
