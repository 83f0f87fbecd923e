// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "command.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {

/// `triskin edit` makes a design from a design with these options. `triskin design` accepts them for one more release.
struct EditOptions {
  int take = -1;
  std::string remove, add, keep, mirror;
  std::string kinds;  ///< The value is a file or "none"; a mesh can have it too.

  void add_to(CLI::App& app);
  /// Hides these options from --help, except --kinds.
  static void hide(CLI::App& app);
  [[nodiscard]] bool any() const;
  /// Returns true if `from` is a design to change and not a mesh.
  [[nodiscard]] bool wanted(const std::string& from) const;
  /// Returns the kinds in the file; none without a file.
  [[nodiscard]] design::KindPlan kind_plan() const;
  /// Throws InputError for other options that would have no effect, because limits and price are those of the design.
  void require_fitting(const CLI::App& app, const std::string& from) const;
};

/// Throws InputError, before any work, if a design cannot be written there, or if the name would make another program
/// take the file for a mesh, a CAD part, a picture or a table.
void require_design_output(const std::string& path);

/// Makes the design `to` from the design `from`. `effort` is for --keep. Returns the exit status.
int edit(const std::string& from, const std::string& to, const EditOptions& options,
         const pipeline::DesignOptions& effort, Output& output);

/// Reports the coverage of the regions. Returns false if a must-cover place is not covered.
bool report_regions(const design::Design& design, Output& output);
/// Reports the number of modules of each kind, unless the design has no kinds.
void report_kinds(const design::Design& design, Output& output);

/// Lists the layouts by modules and price and marks the chosen one.
void report_alternatives(const design::Design& design, Output& output);

}  // namespace triskin::cli
