// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/diagnose/finding_kind.hpp"
#include "triskin/wire/topology.hpp"

namespace triskin::device {

/// One way in which the modules and joints that were found differ from a patch of a design: the third group
/// of FindingKind, and kSwappedModules.
struct TopologyDifference {
  FindingKind kind = FindingKind::kMissingModule;
  int module = -1;  ///< It is a module of the design.
  int other = -1;   ///< It is the second module of a joint or an exchange.
  int steps = 0;    ///< With kRotatedModule it is turned by this many times 120°, 1 or 2.
  std::string text;
  std::string remedy;
};

/// Found topology matched to one patch of a design.
struct TopologyMatch {
  int patch = -1;
  std::vector<int> module_of;  ///< Each found module has its module of the design, or −1 if none fits.
  int agreeing_joints = 0;     ///< Both have so many joints in common.
  std::vector<TopologyDifference> differences;
  /// True: more differences than agreeing joints, so that this is hardly the patch.
  [[nodiscard]] bool another_patch() const { return static_cast<int>(differences.size()) > agreeing_joints + 1; }
};

/// Compares what was found with patch `patch` (0-based): the match with the fewest differences over all modules that
/// the cable could be plugged into, in all three rotations. No differences means that every joint lies between the
/// ports that the design says. An empty topology or patch gives an empty match. Throws std::out_of_range for a patch
/// that the design lacks. Cost: 3 · modules walks over the joints.
[[nodiscard]] TopologyMatch match_topology(const wire::FoundTopology& found, const design::Design& design, int patch);

/// What a controller without a table finds from the entry of patch `patch` (0-based) when the modules of the patches
/// `open` (ascending, with `patch` itself) are joined across their borders and nobody else holds them: as the firmware
/// does, depth first, ports A, B, C, sixteen modules. All modules are taken as mounted as designed. Throws
/// std::out_of_range for a patch that the design lacks. Cost: O(modules of the design).
[[nodiscard]] wire::FoundTopology topology_across(const design::Design& design, int patch, std::span<const int> open);

/// The patches of a design with the fewest differences, in the order of the design; several when they fit equally well,
/// none when the design has no patch. Cost: match_topology for each patch.
[[nodiscard]] std::vector<TopologyMatch> identify_patch(const wire::FoundTopology& found, const design::Design& design);

}  // namespace triskin::device
