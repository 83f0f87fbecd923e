// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "checked_output.hpp"
#include "command.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::cli {

/// `triskin edit` makes a design from a design with these options.
struct EditOptions {
  int take = -1;
  std::string remove, add, keep, mirror;
  std::string kinds;  ///< a file or "none"

  void add_to(CLI::App& app);
  [[nodiscard]] bool any() const;
};

/// Adds the option --kinds of a mesh and of a design.
void add_kinds(CLI::App& app, std::string& kinds);
/// The kinds in the file that --kinds names; none without a file.
[[nodiscard]] design::KindPlan kind_plan_of(const std::string& kinds);

/// Throws InputError, before any work, if a design cannot be written there, or if the name would make another program
/// take the file for a mesh, a CAD part, a picture or a table.
void require_design_output(const std::string& path);

/// Makes the design `to` from the design `from`. `effort` is for --keep. Returns the exit status.
int edit(const std::string& from, const std::string& to, const EditOptions& options,
         const pipeline::DesignOptions& effort, Output& output);

/// Reports what the checker found in a design that was written, and how long that took.
void report_check(const OutputCheck& check, Output& output);

/// Reports the coverage of the regions. Returns false if a must-cover place is not covered.
bool report_regions(const design::Design& design, Output& output);
/// Reports the number of modules of each kind, unless the design has no kinds.
void report_kinds(const design::Design& design, Output& output);

/// Says how many modules stay and which labels are new or no longer in use, with the keys "kept", "added" and
/// "removed".
void report_labels(const design::Design& before, const design::Design& now, nlohmann::json& result, Output& output);
/// Says which controllers have the wiring that they had (`kept`: EditedDesign::kept_patches), which are wired anew and
/// which are no longer in use, with the key "controllers".
void report_tables(const design::Design& before, const design::Design& now, const std::vector<layout::PatchIndex>& kept,
                   nlohmann::json& result, Output& output);

/// Lists the layouts by modules and price and marks the chosen one.
void report_alternatives(const design::Design& design, Output& output);

}  // namespace triskin::cli
