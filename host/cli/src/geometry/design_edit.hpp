// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/cli/command.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {

/// Options of `triskin edit`, which make a design of a design. `triskin design` takes them for one more release.
struct EditOptions {
  int take = -1;
  std::string remove, add, keep, mirror;
  std::string kinds;  ///< It is a file or "none", also beside a mesh.

  void add_to(CLI::App& app);
  /// Says nothing of them in --help, but for --kinds.
  static void hide(CLI::App& app);
  /// True if any of them is given.
  [[nodiscard]] bool any() const;
  /// True if `from` is a design that is to be changed, not a mesh.
  [[nodiscard]] bool wanted(const std::string& from) const;
  /// Kinds of the file; none without one.
  [[nodiscard]] design::KindPlan kind_plan() const;
  /// Throws InputError for options beside these that would have no effect: limits and price are those of the design.
  void require_fitting(const CLI::App& app, const std::string& from) const;
};

/// Makes the design `to` of the design `from`. `effort`: of --keep. Returns the exit status.
int edit(const std::string& from, const std::string& to, const EditOptions& options,
         const pipeline::DesignOptions& effort, Output& output);

/// Reports the coverage of the regions. False: a place that must be covered is not.
bool report_regions(const design::Design& design, Output& output);
/// Reports the number of modules of each kind; nothing for a design without kinds.
void report_kinds(const design::Design& design, Output& output);

/// Modules against price, the layout that is taken marked.
void report_alternatives(const design::Design& design, Output& output);

}  // namespace triskin::cli
