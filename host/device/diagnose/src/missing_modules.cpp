// SPDX-License-Identifier: GPL-3.0-or-later
#include "missing_modules.hpp"

#include <algorithm>
#include <map>

#include "triskin/design/joint.hpp"

namespace triskin::diagnose {
namespace {

using Joints =
    std::map<layout::ModuleId, std::set<layout::ModuleId>>;  // Each module has the set of modules that it is joined to.

Joints joints_by_module(const design::Design& design, layout::PatchIndex patch) {
  const auto& modules = design.patches.at(static_cast<std::size_t>(patch)).modules;
  const design::PortEnds ends = design::joints_of(design, patch);
  Joints joints;
  for (std::size_t row = 0; row < modules.size(); ++row) {
    for (const design::PortEnd& end : ends[row]) {
      if (end.row >= 0)
        joints[layout::ModuleId{modules[row].node}].emplace(modules[static_cast<std::size_t>(end.row)].node);
    }
  }
  return joints;
}

// Returns the missing modules that are connected to `first`; a break between them could not be observed.
std::set<layout::ModuleId> component_of(layout::ModuleId first, const std::set<layout::ModuleId>& missing,
                                        const Joints& joints) {
  std::set<layout::ModuleId> component{first};
  std::vector<layout::ModuleId> open{first};
  while (!open.empty()) {
    const auto around = joints.find(open.back());
    open.pop_back();
    if (around == joints.end()) continue;
    for (const layout::ModuleId next : around->second) {
      if (missing.contains(next) && component.insert(next).second) open.push_back(next);
    }
  }
  return component;
}

// Returns the modules of a component that are joined to a found module, with these found modules.
std::map<layout::ModuleId, std::vector<layout::ModuleId>> ways_into(const std::set<layout::ModuleId>& component,
                                                                    const Joints& joints) {
  std::map<layout::ModuleId, std::vector<layout::ModuleId>> ways;
  for (const layout::ModuleId m : component) {
    const auto around = joints.find(m);
    if (around == joints.end()) continue;
    for (const layout::ModuleId other : around->second) {
      if (!component.contains(other)) ways[m].push_back(other);
    }
  }
  return ways;
}

std::vector<MissingCause> causes_of(const std::set<layout::ModuleId>& component, const Joints& joints,
                                    const std::set<layout::ModuleId>& alive) {
  const auto ways = ways_into(component, joints);
  const bool others_live = std::ranges::any_of(component, [&](layout::ModuleId m) { return alive.contains(m); });
  std::vector<MissingCause> causes;
  for (const auto& [module, found] : ways) {
    const bool dead = !alive.contains(module) && (others_live || component.size() == 1);
    if (found.size() == 1 && !dead) {
      causes.push_back({FindingKind::kMissingJoint, module, found.front(), {}});
    } else if (alive.contains(module)) {
      for (const layout::ModuleId other : found) causes.push_back({FindingKind::kMissingJoint, module, other, {}});
    } else {
      causes.push_back({FindingKind::kMissingModule, module, layout::ModuleId::none(), {}});
    }
  }
  if (!causes.empty()) return causes;
  // No module of the patch was found. A module that another controller reads cannot be the dead one.
  const auto dead = std::ranges::find_if(component, [&](layout::ModuleId m) { return !alive.contains(m); });
  return {{FindingKind::kMissingModule,
           dead == component.end() ? *component.begin() : *dead,
           layout::ModuleId::none(),
           {}}};
}

// The modules that no cause names are listed behind the first one.
std::vector<MissingCause> explain_component(const std::set<layout::ModuleId>& component, const Joints& joints,
                                            const std::set<layout::ModuleId>& alive) {
  std::vector<MissingCause> causes = causes_of(component, joints, alive);
  std::set<layout::ModuleId> rest = component;
  for (const MissingCause& c : causes) {
    if (c.kind == FindingKind::kMissingModule) rest.erase(c.module);
  }
  causes.front().behind.assign(rest.begin(), rest.end());
  return causes;
}

}  // namespace

std::vector<MissingCause> explain_missing(const design::Design& design, layout::PatchIndex patch,
                                          const std::set<layout::ModuleId>& missing,
                                          const std::set<layout::ModuleId>& alive) {
  const Joints joints = joints_by_module(design, patch);
  std::vector<MissingCause> causes;
  std::set<layout::ModuleId> seen;
  for (const layout::ModuleId m : missing) {
    if (seen.contains(m)) continue;
    const std::set<layout::ModuleId> component = component_of(m, missing, joints);
    seen.insert(component.begin(), component.end());
    for (MissingCause& cause : explain_component(component, joints, alive)) causes.push_back(std::move(cause));
  }
  return causes;
}

}  // namespace triskin::diagnose
