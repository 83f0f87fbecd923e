// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/jobs/topology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "triskin/design/joint.hpp"

namespace triskin::device {
namespace {

constexpr const char* kPorts = "ABC";

struct Side {
  int row = -1, side = 0;
};

// Lays what was found over the patch: the entry as given, then along the joints that the design has too.
class Overlay {
 public:
  Overlay(const wire::FoundTopology& found, const design::Design& design, int patch)
      : found_(found),
        modules_(design.patches[static_cast<std::size_t>(patch)].modules),
        second_entry_(design.patches[static_cast<std::size_t>(patch)].second_entry),
        second_side_(design.patches[static_cast<std::size_t>(patch)].second_entry_side) {
    // Joints by tile side: rotations of zero make a port its side.
    const std::vector<int> upright(modules_.size(), 0);
    sides_ = design::joints_of(design, patch, upright);
    result_.patch = patch;
  }

  TopologyMatch run(int entry_row, int rotation) {
    place(entry_row, rotation);
    result_.differences.clear();
    result_.agreeing_joints = 0;
    examine_entry(entry_row);
    examine_rotations();
    examine_joints();
    examine_modules();
    for (std::size_t m = 0; m < found_.count; ++m) result_.module_of.push_back(row_[m] < 0 ? -1 : module_at(row_[m]));
    return result_;
  }

 private:
  [[nodiscard]] int module_at(int row) const { return modules_[static_cast<std::size_t>(row)].node; }
  [[nodiscard]] int designed_rotation(int row) const { return modules_[static_cast<std::size_t>(row)].rotation; }
  [[nodiscard]] Side across(int row, int side) const {
    const design::PortEnd end = sides_[static_cast<std::size_t>(row)][static_cast<std::size_t>(side)];
    return {end.row, end.port};
  }
  [[nodiscard]] std::optional<layout::JointEnd> far(std::size_t m, int port) const {
    const layout::JointEnd end = layout::joint_end(found_.joints[m][static_cast<std::size_t>(port)]);
    return end.exists() ? std::optional(end) : std::nullopt;
  }
  [[nodiscard]] int side_of(std::size_t m, int port) const { return (port + rotation_[m]) % 3; }

  void place(int entry_row, int rotation) {
    row_.assign(found_.count, -1);
    rotation_.assign(found_.count, 0);
    std::set<int> taken{entry_row};
    std::vector<std::size_t> queue{0};
    row_[0] = entry_row;
    rotation_[0] = rotation;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const std::size_t m = queue[k];
      for (int port = 0; port < 3; ++port) {
        const auto end = far(m, port);
        const Side there = across(row_[m], side_of(m, port));
        if (!end || there.row < 0 || row_[end->module] >= 0 || !taken.insert(there.row).second) continue;
        row_[end->module] = there.row;
        rotation_[end->module] = (there.side + 3 - end->port) % 3;
        queue.push_back(end->module);
      }
    }
  }

  void add(FindingKind kind, int module, int other, std::string text, std::string remedy, int steps = 0) {
    result_.differences.push_back({kind, module, other, steps, std::move(text), std::move(remedy)});
  }

  void examine_entry(int entry_row) {
    const int cable_side = side_of(0, found_.cable_port);
    if (found_.second_cable && module_at(entry_row) == second_entry_ && cable_side == second_side_) {
      add(FindingKind::kSecondCable, module_at(0), module_at(entry_row),
          fmt::format(
              "the patch is read over its second cable, at module {}; over the first, at module {}, too little answers",
              module_at(entry_row), module_at(0)),
          "check the first cable and its module");
      return;
    }
    if (entry_row == 0 && cable_side == designed_rotation(0)) return;
    add(FindingKind::kWrongEntry, module_at(0), module_at(entry_row),
        fmt::format("the cable is plugged into side {} of module {}, the design has it at side {} of module {}",
                    cable_side, module_at(entry_row), designed_rotation(0), module_at(0)),
        "plug it where the assembly sheet says");
  }

  // Two modules that were exchanged and kept their rotations show as two rotated ones.
  void examine_rotations() {
    std::vector<std::size_t> turned;
    for (std::size_t m = 0; m < row_.size(); ++m) {
      if (row_[m] >= 0 && rotation_[m] != designed_rotation(row_[m])) turned.push_back(m);
    }
    while (!turned.empty()) {
      const std::size_t a = turned.front();
      turned.erase(turned.begin());
      const auto partner = std::ranges::find_if(turned, [&](std::size_t b) {
        return rotation_[a] == designed_rotation(row_[b]) && rotation_[b] == designed_rotation(row_[a]);
      });
      const int module = module_at(row_[a]);
      if (partner != turned.end()) {
        const int other = module_at(row_[*partner]);
        add(FindingKind::kSwappedModules, module, other,
            fmt::format("modules {} and {} are exchanged: each is turned as the other should be", module, other),
            "exchange them, or turn both as the assembly sheet says");
        turned.erase(partner);
        continue;
      }
      const int steps = (rotation_[a] + 3 - designed_rotation(row_[a])) % 3;
      add(FindingKind::kRotatedModule, module, -1,
          fmt::format("module {} is turned by {}°: port A lies at side {} instead of {}", module, 120 * steps,
                      rotation_[a], designed_rotation(row_[a])),
          "turn it as the assembly sheet says", steps);
    }
  }

  void examine_joints() {
    std::set<std::pair<int, int>> seen;
    for (std::size_t m = 0; m < row_.size(); ++m) {
      for (int port = 0; port < 3; ++port) {
        const auto end = far(m, port);
        if (!end || std::pair<std::size_t, int>(end->module, end->port) < std::pair(m, port)) continue;
        if (row_[m] >= 0 && row_[end->module] >= 0) {
          const Side there = across(row_[m], side_of(m, port));
          if (there.row == row_[end->module] && there.side == side_of(end->module, end->port)) {
            seen.insert(std::minmax(row_[m], there.row));
            ++result_.agreeing_joints;
            continue;
          }
        }
        extra_joint(m, port, *end);
      }
    }
    for (int a = 0; a < static_cast<int>(sides_.size()); ++a) {
      for (int side = 0; side < 3; ++side) {
        const int b = across(a, side).row;
        if (b < a || seen.contains({a, b}) || !placed(a) || !placed(b)) continue;
        add(FindingKind::kMissingJoint, module_at(a), module_at(b),
            fmt::format("nothing passes between module {} and module {}, which are joined in the design", module_at(a),
                        module_at(b)),
            "look for a broken or unsoldered joint between them");
      }
    }
  }

  void extra_joint(std::size_t m, int port, layout::JointEnd end) {
    const bool known = row_[m] >= 0 && row_[end.module] >= 0;
    if (!known) return;  // kExtraModule reports this end
    add(FindingKind::kExtraJoint, module_at(row_[m]), module_at(row_[end.module]),
        fmt::format("port {} of module {} and port {} of module {} are joined, in the design they are not",
                    kPorts[port], module_at(row_[m]), kPorts[end.port], module_at(row_[end.module])),
        "part this joint");
  }

  [[nodiscard]] bool placed(int row) const { return std::ranges::find(row_, row) != row_.end(); }

  void examine_modules() {
    for (int row = 0; row < static_cast<int>(modules_.size()); ++row) {
      if (placed(row)) continue;
      add(FindingKind::kMissingModule, module_at(row), -1,
          fmt::format("module {} was not found: it or all of its joints are broken", module_at(row)),
          "check its supply and its joints, then the module");
    }
    for (std::size_t m = 0; m < row_.size(); ++m) {
      if (row_[m] >= 0) continue;
      add(FindingKind::kExtraModule, -1, -1, fmt::format("found module {} fits nowhere in the design", m),
          "compare the patch with the assembly sheet");
    }
  }

  const wire::FoundTopology& found_;
  const std::vector<design::RoutedModule>& modules_;
  int second_entry_, second_side_;
  design::PortEnds sides_;
  std::vector<int> row_, rotation_;  // by found number
  TopologyMatch result_;
};

}  // namespace

TopologyMatch match_topology(const wire::FoundTopology& found, const design::Design& design, int patch) {
  const auto rows = static_cast<int>(design.patches.at(static_cast<std::size_t>(patch)).modules.size());
  TopologyMatch best;
  best.patch = patch;
  if (found.count == 0 || rows == 0) return best;
  bool first = true;
  for (int entry = 0; entry < rows; ++entry) {
    for (int rotation = 0; rotation < 3; ++rotation) {
      TopologyMatch match = Overlay(found, design, patch).run(entry, rotation);
      if (!first && match.differences.size() >= best.differences.size()) continue;
      best = std::move(match);
      first = false;
    }
  }
  return best;
}

std::vector<TopologyMatch> identify_patch(const wire::FoundTopology& found, const design::Design& design) {
  std::vector<TopologyMatch> matches;
  for (std::size_t p = 0; p < design.patches.size(); ++p)
    matches.push_back(match_topology(found, design, static_cast<int>(p)));
  std::ranges::stable_sort(matches, {}, [](const TopologyMatch& m) { return m.differences.size(); });
  if (matches.empty()) return matches;
  const std::size_t fewest = matches.front().differences.size();
  std::erase_if(matches, [&](const TopologyMatch& m) { return m.differences.size() > fewest; });
  return matches;
}

}  // namespace triskin::device
