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

/// A kind of module: what a builder orders, and what a reader of samples has to know. All kinds have one outline and
/// one wiring, so that placement and routing do not depend on them (the reference paper, Section III-A).
struct ModuleKind {
  std::string name;  ///< It is unique in a design and not empty.
  /// Inputs 0 … taxels − 1 of the converter are electrodes; the number is 1 … 12.
  int taxels = layout::kTaxelsPerModule;
  std::string dielectric;                   ///< It is text for the bill of materials and may be empty.
  double sensitivity_counts_per_kpa = 0.0;  ///< It is not negative; 0 means that it is not stated.
  bool operator==(const ModuleKind&) const = default;
};

/// Kind of all modules of a region.
struct KindRegion {
  CoverPart region;
  int kind = 0;  ///< It is the number of the kind.
  bool operator==(const KindRegion&) const = default;
};

/// Kinds of the modules of a design and where they are. A module holds the number of its kind: 0 is the standard kind
/// of the iCub skin (12 taxels), number k ≥ 1 is kinds[k − 1].
struct KindPlan {
  /// Name of kind 0.
  static constexpr std::string_view kStandard = "standard";

  std::vector<ModuleKind> kinds;    ///< There are at most layout::kMaxKinds − 1.
  std::vector<KindRegion> regions;  ///< Where regions overlap the last one counts; elsewhere modules are of kind 0.
  /// No kinds: all modules are of the standard kind, and no file or table says a word of it.
  [[nodiscard]] bool empty() const { return kinds.empty(); }
  bool operator==(const KindPlan&) const = default;
};

/// The kind with number `kind`. Errors: std::out_of_range for one that the plan lacks. Constant cost.
[[nodiscard]] ModuleKind kind_of(const KindPlan& plan, int kind);
/// Number of the kind with this name; nullopt when the plan lacks it. Cost: one comparison a kind.
[[nodiscard]] std::optional<int> number_of_kind(const KindPlan& plan, std::string_view name);

/// Reads a file of kinds (docs/kinds.md). Errors: InputError naming file and key for a file that cannot be read, no or
/// too many kinds, a name that stands twice, is empty or "standard", values out of range, and a region of an unknown
/// kind. Cost: linear.
[[nodiscard]] KindPlan read_kind_plan(const std::filesystem::path& path);
/// Reads the members "kinds" and "regions" of `v`, as the file and the design file have them. Errors as above.
[[nodiscard]] KindPlan kind_plan_of(const JsonValue& v);
/// The object that kind_plan_of() reads. Cost: linear.
[[nodiscard]] nlohmann::json kind_plan_json(const KindPlan& plan);

/// Gives every module of the layout its kind by all regions of the plan. Errors: InputError for a region that names a
/// module or an island that the layout lacks. Cost: modules times regions.
void assign_kinds(const KindPlan& plan, ModuleLayout& layout);
/// The same by spheres and boxes alone, for the modules from number `first` on: lists of modules and islands mean those
/// of another layout. Cost as above.
void assign_kinds_by_place(const KindPlan& plan, ModuleLayout& layout, std::size_t first = 0);

/// How many modules of a layout are of each kind, by number, kind 0 first. Errors: std::out_of_range for a kind that
/// the plan lacks. Cost: linear.
[[nodiscard]] std::vector<int> count_kinds(const KindPlan& plan, const ModuleLayout& layout);

}  // namespace triskin::design
