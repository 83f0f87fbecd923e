// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace triskin::check {

/// Names one broken rule, the place and the numbers.
struct Violation {
  std::string rule;   ///< docs/check.md lists the names.
  std::string where;  ///< The place reads "module 12", "module 3 side 1", "patch 0", "piece 2" or "design".
  std::string text;   ///< The text compares the measured number with the limit.
};

/// A joint that is bent more than the board of a module can be (docs/fabrication.md).
struct SharpJoint {
  std::array<int, 2> module{};  ///< numbers, the lower one first
  double bend_rad = 0.0, limit_rad = 0.0;
  bool has_cable = false;  ///< The entry's cable is soldered there, which leaves less room for the bend.
};

/// The design keeps all rules when `violations` is empty.
struct DesignReport {
  /// A design without modules cannot break a rule, so a caller should look at this number too.
  std::size_t modules = 0;
  std::vector<std::string> rules;  ///< All rules that were checked are listed, also those that are kept.
  std::vector<Violation> violations;
  /// Each limit that the file states and that was checked has its name and value.
  std::vector<std::pair<std::string, double>> limits;
  /// No rule is broken by these, because a skin may be made of other modules; but `fabricate` has no boards for them.
  /// The one farthest beyond its limit comes first.
  std::vector<SharpJoint> sharp_joints;
  double corner_cut_mm = 0.0;  ///< The modules measured had this corner cut; 0 means whole triangles.
};

/// Checks every rule of a design file against the mesh that the file holds. Shares no code with the solvers: own
/// reader, own geometry (CGAL's exact predicates and its tree of triangles). Errors: InputError when the file cannot be
/// read as a design; broken rules are no errors but violations. One thread; thread-safe. Cost: about 300 closest-point
/// queries per module, some hundred more at the border.
[[nodiscard]] DesignReport check_design(const std::filesystem::path& path);
/// Checks the same of the text of a design file; errors name it `name`.
[[nodiscard]] DesignReport check_design_text(const std::string& text, const std::string& name);

}  // namespace triskin::check
