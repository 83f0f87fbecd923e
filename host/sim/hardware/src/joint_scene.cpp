// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/joint_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::hardware {
namespace {

constexpr double kApart_mm = 10'000.0;

// FNV-1a with 64 bits gives the same hash on every compiler.
std::uint64_t hash_of(std::string_view text, std::uint64_t more) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  const auto add = [&](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001B3ULL; };
  for (const char c : text) add(static_cast<std::uint8_t>(c));
  for (int shift = 0; shift < 64; shift += 8) add(static_cast<std::uint8_t>(more >> shift));
  return hash;
}

// Another design has other boards. With a seed their ids are in random order, as on a workbench; without one they
// follow the node addresses.
wire::UniqueId board_of(const SimulatedCover& cover, std::size_t patch, std::optional<std::uint64_t> seed) {
  if (patch < cover.boards.size() && cover.boards[patch] != wire::UniqueId{}) return cover.boards[patch];
  wire::UniqueId id{};
  std::uint64_t hash = hash_of(cover.name, cover.design->design_id);
  if (seed) {
    hash = hash_of(cover.name, hash_of(cover.name, hash ^ *seed) ^ patch);
    const std::uint64_t first = hash_of(cover.name, hash);
    for (std::size_t k = 0; k < 4; ++k) id[k] = static_cast<std::uint8_t>(first >> (24 - 8 * k));
  } else {
    id[0] = static_cast<std::uint8_t>(design::node_address_of(*cover.design, layout::PatchIndex{patch}));
  }
  for (std::size_t k = 0; k < 8; ++k) id[4 + k] = static_cast<std::uint8_t>(hash >> (56 - 8 * k));
  return id;
}

// Modules keep their ids; a patch on another bus has no controller here. Returns the new number of each patch, or −1.
std::vector<int> leave_out_elsewhere(Scene& scene) {
  design::Design& d = scene.design;
  std::vector<design::Patch> patches;
  std::vector<std::uint8_t> addresses;
  std::vector<wire::UniqueId> boards;
  std::vector<double> clock_ppm;
  std::vector<ControllerLevel> levels;
  std::vector<int> numbers(d.patches.size(), -1);
  for (std::size_t p = 0; p < d.patches.size(); ++p) {
    if (d.node_addresses[p] == 0) continue;
    numbers[p] = static_cast<int>(patches.size());
    patches.push_back(std::move(d.patches[p]));
    addresses.push_back(d.node_addresses[p]);
    boards.push_back(scene.boards[p]);
    levels.push_back(scene.levels[p]);
    if (!scene.effects.clock_ppm.empty()) clock_ppm.push_back(scene.effects.clock_ppm[p]);
  }
  d.patches = std::move(patches);
  d.node_addresses = std::move(addresses);
  scene.boards = std::move(boards);
  scene.effects.clock_ppm = std::move(clock_ppm);
  scene.levels = std::move(levels);
  return numbers;
}

Contact moved(Contact c, const design::Vec3& by_mm) {
  c.position_mm += by_mm;
  if (c.to_mm) *c.to_mm += by_mm;
  for (Keyframe& k : c.keyframes) k.position_mm += by_mm;
  return c;
}

// Renumbers the faults of one cover.
class FaultsHere {
 public:
  FaultsHere(const Scene& joint, const std::vector<int>& patch_numbers)
      : wiring_(design::wiring_of(joint.design)), patch_numbers_(patch_numbers) {}
  // Returns nothing if the fault is at a controller on another bus.
  [[nodiscard]] std::optional<Fault> renumbered(const Fault& fault, const SimulatedCover& cover,
                                                const design::CoverOffset& offset) const {
    Fault f = fault;
    const auto patch_here = [&](layout::PatchIndex patch) {
      return patch < 0 ? layout::PatchIndex::none()
                       : layout::PatchIndex{patch_numbers_.at(static_cast<std::size_t>(offset.patch + patch))};
    };
    f.patch = patch_here(fault.patch);
    f.other_patch = patch_here(fault.other_patch);
    if (f.other >= 0) f.other = layout::ModuleId{offset.module + f.other};
    if (f.module >= 0) f.module = layout::ModuleId{offset.module + f.module};
    const bool here = fault.patch < 0 || f.patch >= 0;
    if (fault.other_patch >= 0 && here != (f.other_patch >= 0)) refuse(fault, cover, fault.patch, fault.other_patch);
    if (f.kind == FaultKind::kSwappedChips && is_read(f.module) != is_read(f.other))
      refuse(fault, cover, fault.module, fault.other);
    return here ? std::optional(f) : std::nullopt;
  }

 private:
  [[nodiscard]] bool is_read(layout::ModuleId module) const {
    return wiring_.at(static_cast<std::size_t>(module)).patch >= 0;
  }
  [[noreturn]] static void refuse(const Fault& fault, const SimulatedCover& cover, int first, int second) {
    throw InputError(
        fmt::format("part {}: fault {} of {} and {}: their controllers are on different buses, which are "
                    "simulated apart; choose two on one bus",
                    cover.name, kFaultKindNames.name(fault.kind), first, second));
  }
  std::vector<design::ModuleWiring> wiring_;
  const std::vector<int>& patch_numbers_;
};

// If a clock is named, those that are not have no deviation.
void join_clocks(Scene& joint, std::span<const SimulatedCover> covers) {
  joint.effects.clock_ppm.clear();
  const auto has_clock = [](const SimulatedCover& c) {
    return c.scene != nullptr && !c.scene->effects.clock_ppm.empty();
  };
  if (std::ranges::none_of(covers, has_clock)) return;
  for (const SimulatedCover& c : covers) {
    std::vector<double> clocks = c.scene == nullptr ? std::vector<double>{} : c.scene->effects.clock_ppm;
    clocks.resize(c.design->patches.size(), 0.0);
    joint.effects.clock_ppm.insert(joint.effects.clock_ppm.end(), clocks.begin(), clocks.end());
  }
}

// The surroundings are common to all covers.
void take_surroundings(Scene& joint, std::span<const SimulatedCover> covers) {
  const Scene* common = covers.empty() ? nullptr : covers.front().scene;
  if (common != nullptr) {
    joint.seed = common->seed;
    joint.switched = common->switched;
    joint.border_joints = common->border_joints;
    joint.pressure = common->pressure;
    joint.effects = common->effects;
  }
  join_clocks(joint, covers);
}

std::vector<design::PlacedCover> place_apart(std::span<const SimulatedCover> covers) {
  std::vector<design::PlacedCover> placed;
  for (const SimulatedCover& c : covers) {
    design::PlacedCover p{c.design, Eigen::Isometry3d::Identity()};
    p.pose.translation().x() = kApart_mm * static_cast<double>(placed.size());
    placed.push_back(p);
  }
  return placed;
}

// Adds the boards, the levels of their firmware, and the seeds of the modules.
void add_hardware(Scene& joint, const SimulatedCover& c, std::optional<std::uint64_t> board_seed) {
  for (std::size_t patch = 0; patch < c.design->patches.size(); ++patch)
    joint.boards.push_back(board_of(c, patch, board_seed));
  std::vector<ControllerLevel> levels = c.scene == nullptr ? std::vector<ControllerLevel>{} : c.scene->levels;
  levels.resize(c.design->patches.size(), ControllerLevel::kFirmware);
  joint.levels.insert(joint.levels.end(), levels.begin(), levels.end());
  for (std::size_t m = 0; m < c.design->layout.modules.size(); ++m)
    joint.module_seeds.push_back(
        hash_of(c.name, static_cast<std::size_t>(design::number_of(*c.design, static_cast<int>(m)).value)));
}

}  // namespace

JointScene join_covers(std::span<const SimulatedCover> covers, const wire::BitRates& rates,
                       std::optional<std::uint64_t> board_seed) {
  JointScene joint;
  take_surroundings(joint.scene, covers);
  joint.scene.board_seed = board_seed;
  const std::vector<design::PlacedCover> placed = place_apart(covers);
  for (const SimulatedCover& c : covers) {
    joint.names.push_back(c.name);
    add_hardware(joint.scene, c, board_seed);
  }
  design::SideBySide side_by_side = design::side_by_side(placed);
  joint.scene.design = std::move(side_by_side.design);
  joint.scene.design.layout.numbers.clear();  // Covers have equal numbers, and tables of this bus must be told apart.
  joint.offsets = std::move(side_by_side.offsets);
  joint.scene.effects.bus_bit_rate = rates.nominal;
  joint.scene.effects.bus_data_bit_rate = rates.data;
  const std::vector<int> patch_numbers = leave_out_elsewhere(joint.scene);
  const FaultsHere faults(joint.scene, patch_numbers);
  for (std::size_t c = 0; c < covers.size(); ++c) {
    if (covers[c].scene == nullptr) continue;
    for (const Contact& contact : covers[c].scene->contacts)
      joint.scene.contacts.push_back(moved(contact, placed[c].pose.translation()));
    for (const Fault& fault : covers[c].scene->faults)
      if (const auto here = faults.renumbered(fault, covers[c], joint.offsets[c])) joint.scene.faults.push_back(*here);
  }
  return joint;
}

}  // namespace triskin::hardware
