// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "triskin/design/cover_part.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// The kind of a module matters to the person who orders modules and to programs that read samples. All kinds have the
/// same outline and wiring, so that placement and routing do not depend on them (the reference paper, Section III-A).
struct ModuleKind {
  std::string name;  ///< Names are unique in a design and not empty.
  /// Inputs 0 … taxels − 1 of the converter are electrodes; valid numbers are 1 … 12.
  int taxels = layout::kTaxelsPerModule;
  std::string dielectric;                   ///< The text is for the bill of materials and may be empty.
  double sensitivity_counts_per_kpa = 0.0;  ///< Zero means that the sensitivity is not stated; it is never negative.
  bool operator==(const ModuleKind&) const = default;
};

/// Assigns one kind to all modules of a region.
struct KindRegion {
  CoverPart region;
  int kind = 0;  ///< The number of the kind counts as in KindPlan.
  bool operator==(const KindRegion&) const = default;
};

/// A plan lists the kinds of modules in a design and the regions that use them. Each module stores the number of its
/// kind: 0 is the standard kind of the iCub skin (12 taxels), number k ≥ 1 is kinds[k − 1].
struct KindPlan {
  /// Kind 0 has this name.
  static constexpr std::string_view kStandard = "standard";

  std::vector<ModuleKind> kinds;    ///< A plan has at most layout::kMaxKinds − 1 kinds.
  std::vector<KindRegion> regions;  ///< Where regions overlap, the last one applies; elsewhere modules are of kind 0.
  /// Returns true if all modules are of the standard kind; files and tables then do not mention kinds.
  [[nodiscard]] bool empty() const { return kinds.empty(); }
  bool operator==(const KindPlan&) const = default;
};

/// Returns the kind with number `kind`. Errors: std::out_of_range for one that the plan lacks. Constant cost.
[[nodiscard]] ModuleKind kind_of(const KindPlan& plan, int kind);
/// Returns the number of the kind with this name; nullopt when the plan lacks it. Cost: one comparison per kind.
[[nodiscard]] std::optional<int> number_of_kind(const KindPlan& plan, std::string_view name);

/// Reads a file of kinds (docs/pipeline.md). Errors: InputError naming file and key for a file that cannot be read, no
/// or too many kinds, a name that occurs twice, is empty or "standard", values out of range, and a region of an unknown
/// kind. Cost: linear.
[[nodiscard]] KindPlan read_kind_plan(const std::filesystem::path& path);
/// Reads the members "kinds" and "regions" of `v`, which a kinds file and a design file have in common. Errors as
/// above.
[[nodiscard]] KindPlan kind_plan_of(const JsonValue& v);
/// Writes the object that kind_plan_of() reads. Cost: linear.
[[nodiscard]] nlohmann::json kind_plan_json(const KindPlan& plan);

/// Assigns a kind to every module of the layout by all regions of the plan. Errors: InputError for a region that names
/// a module or an island that the layout lacks. Cost: modules times regions.
void assign_kinds(const KindPlan& plan, ModuleLayout& layout);
/// Assigns kinds by spheres and boxes alone, to the modules from number `first` on, because lists of modules and
/// islands refer to another layout. Cost: modules times regions.
void assign_kinds_by_place(const KindPlan& plan, ModuleLayout& layout, std::size_t first = 0);

/// Counts the modules of each kind, indexed by number. Errors: std::out_of_range for a kind that the plan lacks. Cost:
/// linear.
[[nodiscard]] std::vector<int> count_kinds(const KindPlan& plan, const ModuleLayout& layout);

}  // namespace triskin::design
