// SPDX-License-Identifier: GPL-3.0-or-later
#include "missing_modules.hpp"

#include <algorithm>
#include <map>

#include "triskin/design/joint.hpp"

namespace triskin::device {
namespace {

using Joints = std::map<int, std::set<int>>;  // Each module has the set of modules that it is joined to.

Joints joints_by_module(const design::Design& design, int patch) {
  const auto& modules = design.patches.at(static_cast<std::size_t>(patch)).modules;
  const design::PortEnds ends = design::joints_of(design, patch);
  Joints joints;
  for (std::size_t row = 0; row < modules.size(); ++row) {
    for (const design::PortEnd& end : ends[row]) {
      if (end.row >= 0) joints[modules[row].node].insert(modules[static_cast<std::size_t>(end.row)].node);
    }
  }
  return joints;
}

// Returns the missing modules that are connected to `first`; a break between them could not be observed.
std::set<int> component_of(int first, const std::set<int>& missing, const Joints& joints) {
  std::set<int> component{first};
  std::vector<int> open{first};
  while (!open.empty()) {
    const auto around = joints.find(open.back());
    open.pop_back();
    if (around == joints.end()) continue;
    for (const int next : around->second) {
      if (missing.contains(next) && component.insert(next).second) open.push_back(next);
    }
  }
  return component;
}

// Returns the modules of a component that are joined to a found module, with these found modules.
std::map<int, std::vector<int>> ways_into(const std::set<int>& component, const Joints& joints) {
  std::map<int, std::vector<int>> ways;
  for (const int m : component) {
    const auto around = joints.find(m);
    if (around == joints.end()) continue;
    for (const int other : around->second) {
      if (!component.contains(other)) ways[m].push_back(other);
    }
  }
  return ways;
}

std::vector<MissingCause> causes_of(const std::set<int>& component, const Joints& joints, const std::set<int>& alive) {
  const auto ways = ways_into(component, joints);
  const bool others_live = std::ranges::any_of(component, [&](int m) { return alive.contains(m); });
  std::vector<MissingCause> causes;
  for (const auto& [module, found] : ways) {
    const bool dead = !alive.contains(module) && (others_live || component.size() == 1);
    if (found.size() == 1 && !dead) {
      causes.push_back({FindingKind::kMissingJoint, module, found.front(), {}});
    } else if (alive.contains(module)) {
      for (const int other : found) causes.push_back({FindingKind::kMissingJoint, module, other, {}});
    } else {
      causes.push_back({FindingKind::kMissingModule, module, -1, {}});
    }
  }
  if (!causes.empty()) return causes;
  // No module of the patch was found. A module that another controller reads cannot be the dead one.
  const auto dead = std::ranges::find_if(component, [&](int m) { return !alive.contains(m); });
  return {{FindingKind::kMissingModule, dead == component.end() ? *component.begin() : *dead, -1, {}}};
}

// The modules that no cause names are listed behind the first one.
std::vector<MissingCause> explain_component(const std::set<int>& component, const Joints& joints,
                                            const std::set<int>& alive) {
  std::vector<MissingCause> causes = causes_of(component, joints, alive);
  std::set<int> rest = component;
  for (const MissingCause& c : causes) {
    if (c.kind == FindingKind::kMissingModule) rest.erase(c.module);
  }
  causes.front().behind.assign(rest.begin(), rest.end());
  return causes;
}

}  // namespace

std::vector<MissingCause> explain_missing(const design::Design& design, int patch, const std::set<int>& missing,
                                          const std::set<int>& alive) {
  const Joints joints = joints_by_module(design, patch);
  std::vector<MissingCause> causes;
  std::set<int> seen;
  for (const int m : missing) {
    if (seen.contains(m)) continue;
    const std::set<int> component = component_of(m, missing, joints);
    seen.insert(component.begin(), component.end());
    for (MissingCause& cause : explain_component(component, joints, alive)) causes.push_back(std::move(cause));
  }
  return causes;
}

}  // namespace triskin::device
