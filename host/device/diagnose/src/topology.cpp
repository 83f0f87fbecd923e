// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/diagnose/topology.hpp"

#include <algorithm>
#include <compare>
#include <optional>
#include <ranges>
#include <set>

#include "rules.hpp"
#include "triskin/design/joint.hpp"

namespace triskin::diagnose {
namespace {

constexpr const char* kPorts = "ABC";

// A module has three numbers here: its position in the design's patch, its number in the topology that was found, and
// its id in the design.
enum class PatchRow : std::size_t {};
enum class FoundNumber : std::size_t {};
constexpr std::size_t index(PatchRow row) {
  return static_cast<std::size_t>(row);
}
constexpr std::size_t index(FoundNumber number) {
  return static_cast<std::size_t>(number);
}
template <class Number>
auto all(std::size_t count) {
  return std::views::iota(std::size_t{0}, count) | std::views::transform([](std::size_t k) { return Number{k}; });
}

struct Side {
  PatchRow row{};
  int side = 0;
  bool operator==(const Side&) const = default;
};

// A port of a found module is a layout::JointEnd with a typed number.
struct End {
  FoundNumber module{};
  int port = 0;
  auto operator<=>(const End&) const = default;
};

// Overlays the found topology on the patch, starting at the given entry and following the joints that the design has
// too.
class Overlay {
 public:
  Overlay(const wire::FoundTopology& found, const design::Design& design, layout::PatchIndex patch)
      : found_(found), design_(design), patch_(design.patches[static_cast<std::size_t>(patch)]) {
    // With rotations of zero, ports are numbered like sides, so this gives joints by tile side.
    const std::vector<int> upright(patch_.modules.size(), 0);
    sides_ = design::joints_of(design, patch, upright);
    result_.patch = patch;
  }

  TopologyMatch run(PatchRow entry_row, int rotation) {
    place(entry_row, rotation);
    examine_entry(entry_row);
    examine_rotations();
    examine_joints();
    examine_modules();
    for (const FoundNumber m : all<FoundNumber>(found_.count)) {
      const auto row = row_of(m);
      result_.module_of.push_back(row ? module_at(*row) : layout::ModuleId::none());
    }
    return result_;
  }

 private:
  static constexpr PatchRow kEntryRow{0};

  [[nodiscard]] layout::ModuleId module_at(PatchRow row) const {
    return layout::ModuleId{patch_.modules[index(row)].node};
  }
  [[nodiscard]] int designed_rotation(PatchRow row) const { return patch_.modules[index(row)].rotation; }
  [[nodiscard]] std::optional<PatchRow> row_of(FoundNumber m) const { return row_[index(m)]; }
  [[nodiscard]] int rotation_of(FoundNumber m) const { return rotation_[index(m)]; }
  // Returns the designed far end of a joint, or nothing if there is no joint.
  [[nodiscard]] std::optional<Side> across(const Side& at) const {
    const design::PortEnd end = sides_[index(at.row)][static_cast<std::size_t>(at.side)];
    if (end.row < 0) return std::nullopt;
    return Side{PatchRow{static_cast<std::size_t>(end.row)}, end.port};
  }
  // Returns the far end of a joint that was found, or nothing.
  [[nodiscard]] std::optional<End> far(const End& at) const {
    const auto end = layout::joint_end(found_.joints[index(at.module)][static_cast<std::size_t>(at.port)]);
    if (!end.exists()) return std::nullopt;
    return End{FoundNumber{end.module}, end.port};
  }
  // Returns the side of the design at which a port lies, or nothing if its module fits nowhere.
  [[nodiscard]] std::optional<Side> side_of(const End& at) const {
    const auto row = row_of(at.module);
    if (!row) return std::nullopt;
    return Side{*row, (at.port + rotation_of(at.module)) % 3};
  }

  void seat(FoundNumber module, PatchRow row, int rotation) {
    row_[index(module)] = row;
    rotation_[index(module)] = rotation;
  }
  void place(PatchRow entry_row, int rotation) {
    row_.assign(found_.count, std::nullopt);
    rotation_.assign(found_.count, 0);
    std::set<PatchRow> taken{entry_row};
    std::vector<FoundNumber> queue{FoundNumber{0}};
    seat(FoundNumber{0}, entry_row, rotation);
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (int port = 0; port < 3; ++port) {
        const End here{queue[k], port};
        const auto end = far(here);
        const auto there = across(*side_of(here));
        if (!end || !there || row_of(end->module) || !taken.insert(there->row).second) continue;
        seat(end->module, there->row, (there->side + 3 - end->port) % 3);
        queue.push_back(end->module);
      }
    }
  }

  template <class... Words>
  TopologyDifference& add(Seen seen, layout::ModuleId module, layout::ModuleId other, const Words&... words) {
    Finding f = finding(seen, fmt::arg("module", design::number_of(design_, module)),
                        fmt::arg("other", design::number_of(design_, other)), words...);
    return result_.differences.emplace_back(f.kind, module, other, 0, std::move(f.text), std::move(f.remedy));
  }

  void examine_entry(PatchRow entry_row) {
    const layout::ModuleId entry = module_at(entry_row), designed = module_at(kEntryRow);
    const int cable_side = side_of({FoundNumber{0}, found_.cable_port})->side;
    if (found_.second_cable && entry == patch_.second_entry && cable_side == patch_.second_entry_side) {
      add(Seen::kSecondCable, designed, entry, fmt::arg("entry", design::number_of(design_, entry)));
      return;
    }
    if (entry_row == kEntryRow && cable_side == designed_rotation(kEntryRow)) return;
    add(Seen::kOtherEntry, designed, entry, fmt::arg("entry", design::number_of(design_, entry)),
        fmt::arg("side", cable_side), fmt::arg("designed", designed_rotation(kEntryRow)));
  }

  // Two exchanged modules that kept their rotations look like two rotated ones.
  void examine_rotations() {
    std::vector<FoundNumber> turned;
    for (const FoundNumber m : all<FoundNumber>(found_.count)) {
      if (const auto row = row_of(m); row && rotation_of(m) != designed_rotation(*row)) turned.push_back(m);
    }
    while (!turned.empty()) {
      const FoundNumber a = turned.front();
      const PatchRow row = *row_of(a);
      turned.erase(turned.begin());
      const auto partner = std::ranges::find_if(turned, [&](FoundNumber b) {
        return rotation_of(a) == designed_rotation(*row_of(b)) && rotation_of(b) == designed_rotation(row);
      });
      const layout::ModuleId module = module_at(row);
      if (partner != turned.end()) {
        add(Seen::kPairTurned, module, module_at(*row_of(*partner)));
        turned.erase(partner);
        continue;
      }
      const int designed = designed_rotation(row), steps = (rotation_of(a) + 3 - designed) % 3;
      add(Seen::kPortsTurned, module, layout::ModuleId::none(), fmt::arg("degrees", 120 * steps),
          fmt::arg("side", rotation_of(a)), fmt::arg("designed", designed))
          .steps = steps;
    }
  }
  void examine_joints() {
    std::set<std::pair<PatchRow, PatchRow>> agreeing;
    for (const FoundNumber m : all<FoundNumber>(found_.count)) {
      for (int port = 0; port < 3; ++port) examine_found_joint({m, port}, agreeing);
    }
    for (const PatchRow a : all<PatchRow>(patch_.modules.size())) {
      for (int side = 0; side < 3; ++side) {
        const auto end = across({a, side});
        if (!end || end->row < a || agreeing.contains({a, end->row}) || !placed(a) || !placed(end->row)) continue;
        add(Seen::kNothingBetween, module_at(a), module_at(end->row));
      }
    }
  }
  // The walk passes both ends of a joint, but only the lower one counts.
  void examine_found_joint(const End& here, std::set<std::pair<PatchRow, PatchRow>>& agreeing) {
    const auto end = far(here);
    if (!end || *end < here) return;
    const auto a = side_of(here), b = side_of(*end);
    if (!a || !b) return;  // The joint's end is already reported as kExtraModule.
    if (across(*a) == b) {
      agreeing.insert(std::minmax(a->row, b->row));
      ++result_.agreeing_joints;
      return;
    }
    add(Seen::kJointNotDesigned, module_at(a->row), module_at(b->row), fmt::arg("port", kPorts[here.port]),
        fmt::arg("other_port", kPorts[end->port]));
  }

  [[nodiscard]] bool placed(PatchRow row) const { return std::ranges::find(row_, std::optional(row)) != row_.end(); }

  void examine_modules() {
    for (const PatchRow row : all<PatchRow>(patch_.modules.size())) {
      if (placed(row)) continue;
      add(Seen::kModuleNotFound, module_at(row), layout::ModuleId::none(), fmt::arg("behind", ""),
          fmt::arg("meanwhile", ""));
    }
    for (const FoundNumber m : all<FoundNumber>(found_.count)) {
      if (row_of(m)) continue;
      add(Seen::kModuleFitsNowhere, layout::ModuleId::none(), layout::ModuleId::none(), fmt::arg("number", index(m)));
    }
  }

  const wire::FoundTopology& found_;
  const design::Design& design_;
  const design::Patch& patch_;
  design::PortEnds sides_;
  std::vector<std::optional<PatchRow>> row_;
  std::vector<int> rotation_;
  TopologyMatch result_;
};

}  // namespace

TopologyMatch match_topology(const wire::FoundTopology& found, const design::Design& design, layout::PatchIndex patch) {
  const std::size_t rows = design.patches.at(static_cast<std::size_t>(patch)).modules.size();
  TopologyMatch best;
  best.patch = patch;
  if (found.count == 0 || rows == 0) return best;
  bool first = true;
  for (std::size_t entry = 0; entry < rows; ++entry) {
    for (int rotation = 0; rotation < 3; ++rotation) {
      TopologyMatch match = Overlay(found, design, patch).run(PatchRow{entry}, rotation);
      if (!first && match.differences.size() >= best.differences.size()) continue;
      best = std::move(match);
      first = false;
    }
  }
  return best;
}

namespace {

using ModuleEnds = std::vector<std::array<design::ModuleEnd, layout::kPorts>>;

constexpr int kStrange = -2, kFree = -1;  // A module that the search does not reach, or has not reached, has no number.

std::vector<int> unnumbered(const design::Design& design, std::span<const layout::PatchIndex> open) {
  std::vector<int> number(design.layout.modules.size(), kStrange);
  for (const layout::PatchIndex p : open) {
    for (const design::RoutedModule& m : design.patches.at(static_cast<std::size_t>(p)).modules)
      number[static_cast<std::size_t>(m.node)] = kFree;
  }
  return number;
}

void enter(layout::ModuleId module, std::vector<layout::ModuleId>& order, std::vector<int>& number) {
  number[static_cast<std::size_t>(module)] = static_cast<int>(order.size());
  order.push_back(module);
}

// Numbers the modules as the firmware's search does, depth first and the ports in order; returns them in this order.
std::vector<layout::ModuleId> number_modules(const ModuleEnds& ends, layout::ModuleId entry, std::vector<int>& number) {
  std::vector<layout::ModuleId> order, way{entry};
  std::vector<std::size_t> next(ends.size(), 0);  // Each module has the port that is tried next.
  enter(entry, order, number);
  while (!way.empty()) {
    const auto module = static_cast<std::size_t>(way.back());
    if (next[module] == layout::kPorts) {
      way.pop_back();
      continue;
    }
    const layout::ModuleId other = ends[module][next[module]++].module;
    if (other < 0 || number[static_cast<std::size_t>(other)] != kFree || order.size() == layout::kMaxModules) continue;
    enter(other, order, number);
    way.push_back(other);
  }
  return order;
}

}  // namespace

wire::FoundTopology topology_across(const design::Design& design, layout::PatchIndex patch,
                                    std::span<const layout::PatchIndex> open) {
  const design::Patch& own = design.patches.at(static_cast<std::size_t>(patch));
  wire::FoundTopology found;
  if (own.modules.empty()) return found;
  const ModuleEnds ends = design::module_ends(design);
  std::vector<int> number = unnumbered(design, open);
  const std::vector<layout::ModuleId> order = number_modules(ends, layout::ModuleId{own.modules[0].node}, number);
  found.switched = found.complete = true;
  found.count = static_cast<std::uint8_t>(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    for (std::size_t p = 0; p < layout::kPorts; ++p) {
      const design::ModuleEnd& end = ends[static_cast<std::size_t>(order[k])][p];
      const int far = end.module < 0 ? kStrange : number[static_cast<std::size_t>(end.module)];
      if (far >= 0)
        found.joints[k][p] = layout::joint_to({static_cast<std::uint8_t>(far), static_cast<std::uint8_t>(end.port)});
    }
  }
  return found;
}

std::vector<TopologyMatch> identify_patch(const wire::FoundTopology& found, const design::Design& design) {
  std::vector<TopologyMatch> matches;
  for (const layout::PatchIndex p : design::patches_of(design)) matches.push_back(match_topology(found, design, p));
  std::ranges::stable_sort(matches, {}, [](const TopologyMatch& m) { return m.differences.size(); });
  if (matches.empty()) return matches;
  const std::size_t fewest = matches.front().differences.size();
  std::erase_if(matches, [&](const TopologyMatch& m) { return m.differences.size() > fewest; });
  return matches;
}

}  // namespace triskin::diagnose
