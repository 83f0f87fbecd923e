// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/diagnose/finding_kind.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::diagnose {

/// A found topology can differ from a patch of a design in the third group of FindingKind, and in kSwappedModules.
struct TopologyDifference {
  FindingKind kind = FindingKind::kMissingModule;
  layout::ModuleId module = layout::ModuleId::none();
  layout::ModuleId other = layout::ModuleId::none();  ///< It is the second module of a joint or an exchange.
  int steps = 0;  ///< With kRotatedModule the module is turned by this many times 120°, 1 or 2.
  std::string text;
  std::string remedy;
};

/// A found topology is matched to one patch of a design.
struct TopologyMatch {
  layout::PatchIndex patch = layout::PatchIndex::none();
  std::vector<layout::ModuleId> module_of;  ///< Each found module has its module of the design, or −1 if none fits.
  int agreeing_joints = 0;                  ///< Both topologies have this many joints in common.
  std::vector<TopologyDifference> differences;
  /// Returns true if there are more differences than agreeing joints, so that this is hardly the patch.
  [[nodiscard]] bool another_patch() const { return static_cast<int>(differences.size()) > agreeing_joints + 1; }
};

/// Compares a topology with patch `patch` (0-based). It returns the match with the fewest differences over all modules
/// that the cable could be plugged into, in all three rotations. No differences means that every joint lies between the
/// ports that the design says. An empty topology or patch gives an empty match. Throws std::out_of_range for a patch
/// that the design lacks. Cost: 3 · modules walks over the joints.
[[nodiscard]] TopologyMatch match_topology(const wire::FoundTopology& found, const design::Design& design,
                                           layout::PatchIndex patch);

/// Computes what a controller without a table finds from the entry of patch `patch` (0-based) when the modules of the
/// patches `open` (ascending, with `patch` itself) are joined across their borders and no other controller holds them.
/// It searches as the firmware does: depth first, ports A, B, C, sixteen modules. All modules are assumed to be mounted
/// as designed. Throws std::out_of_range for a patch that the design lacks. Cost: O(modules of the design).
[[nodiscard]] wire::FoundTopology topology_across(const design::Design& design, layout::PatchIndex patch,
                                                  std::span<const layout::PatchIndex> open);

/// Returns the patches of a design with the fewest differences, in the order of the design: several when they fit
/// equally well, none when the design has no patch. Cost: match_topology for each patch.
[[nodiscard]] std::vector<TopologyMatch> identify_patch(const wire::FoundTopology& found, const design::Design& design);

}  // namespace triskin::diagnose
