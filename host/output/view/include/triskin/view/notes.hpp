// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"

namespace triskin::view {

/// The page shows each finding of verify at its place.
struct Finding {
  /// Both belong to the displayed design, which joins the covers of a robot; −1 means none.
  layout::SkinModule module = layout::SkinModule::none();
  layout::PatchIndex patch = layout::PatchIndex::none();
  std::string text, remedy;
};

/// Several covers of a robot are shown as one design; each has a note.
struct CoverNote {
  std::string name;
  int first_module = 0, first_patch = 0, first_island = 0;  ///< The numbers refer to the joint design.
  int modules = 0;
  double area_cm2 = 0.0, coverage = 0.0;
};

/// A module is kept, added or removed between two designs.
struct ModuleChange {
  enum class Kind { kKept, kAdded, kRemoved };
  Kind kind = Kind::kKept;
  int other = -1;  ///< The same module has this index in the other half of the joint design; −1 means none.
};

/// The joint design holds two designs, the earlier one first.
struct Changes {
  std::vector<ModuleChange> modules;  ///< The list follows the joint modules; it is empty without a comparison.
  int before_modules = 0;             ///< The earlier design has this many modules.
  int before_vertices = 0;            ///< Its surface has this many vertices.
};

/// What the page shows beside a design.
struct Notes {
  std::vector<CoverNote> covers{};  ///< The list is empty if the design has only one cover.
  std::vector<Finding> findings{};
  bool has_live_skin = false;  ///< True means that the page's server sends samples.
  Changes changes{};
  /// Sensitivity of taxel 12 · module + t in counts/kPa, 0 without a calibration; an empty list leaves counts.
  std::vector<double> counts_per_kpa{};
  bool has_switched_modules = false;  ///< Only these have second cables and are read around a failure.
};

/// Returns the list of Notes; empty if the calibration is not complete. Cost: O(modules).
[[nodiscard]] std::vector<double> counts_per_kpa_of(const design::SkinCalibration& calibration);

/// Reads the findings in a report of `triskin verify` (--report FILE.json, or the output of --json; for a robot with
/// its covers by name). `name` is the file's name, for errors. `notes` has the covers of the displayed design; of a
/// comparison the report is about the later design. Throws InputError for text that is not such a report, and for a
/// module or cover that the design does not have. Cost: linear.
[[nodiscard]] std::vector<Finding> findings_in(std::string_view report, const std::string& name,
                                               const design::Design& design, const Notes& notes);

/// Returns the faces of the whole part that are not covered: the inner side of its wall, and its rims. Empty if the
/// design contains no part. Cost: O(faces) for faces of similar size.
[[nodiscard]] design::Mesh left_out_of_part(const design::Design& design);

/// Returns the thickness of the part's wall under each module in mm; 0 where no second side lies within 8 mm behind the
/// first. Empty for a design that does not contain its whole part. The thickness is measured along the normal at the
/// module's centre. Cost: O(modules + faces) for faces that are small compared to the part.
[[nodiscard]] std::vector<double> wall_under_modules(const design::Design& design);

}  // namespace triskin::view
